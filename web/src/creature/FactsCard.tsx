/** Measures, coupling and origin of a creature. */

import type { Creature } from "../api/types";
import { formOf, groupsOf, originOf } from "./facts";
import { text } from "./text";
import { Term } from "../ui/Term";

export function FactsCard({ creature }: { creature: Creature }) {
  const form = formOf(creature);
  return (
    <section class="card facts-card" aria-labelledby="facts-title">
      <h2 id="facts-title">{text.facts}</h2>
      <div class="facts-columns">
        {groupsOf(creature).map(({ title, rows }) => (
          <div key={title}>
            <h3>{title}</h3>
            <dl class="rows">
              <Rows rows={rows} />
            </dl>
          </div>
        ))}
        {form.length > 0 && (
          <div>
            <h3>{text.coupling}</h3>
            <dl class="rows">
              <Rows rows={form} />
            </dl>
          </div>
        )}
        <div>
          <h3>{text.origin}</h3>
          <dl class="rows">
            <Rows rows={originOf(creature)} />
            <div>
              <dt>SHA-256</dt>
              <dd>
                <code class="long">{creature.sha256}</code>
              </dd>
            </div>
          </dl>
        </div>
      </div>
    </section>
  );
}

function Rows({ rows }: { rows: [name: string, value: string][] }) {
  return rows.map(([name, value]) => (
    <div key={name}>
      <dt>
        <Term name={name} />
      </dt>
      <dd>{value}</dd>
    </div>
  ));
}
