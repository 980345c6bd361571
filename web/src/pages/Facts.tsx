/** What was measured of a creature, in which form, and where it comes from. */

import type { Creature } from "../api/types";
import { UNKNOWN, formOf, measurementsOf, originOf } from "../view/facts";
import { short } from "../view/format";

export function Facts({ creature, run }: { creature: Creature; run: string | null }) {
  const parents = creature.provenance?.parents;
  return (
    <section class="card" aria-labelledby="facts-title">
      <h2 id="facts-title">Measurements</h2>
      <dl class="rows">
        <Rows rows={measurementsOf(creature)} />
      </dl>
      <h3>Coupling</h3>
      <dl class="rows">
        <Rows rows={formOf(creature)} />
      </dl>
      <h3>Origin</h3>
      <dl class="rows">
        <Rows rows={originOf(creature)} />
        <div>
          <dt>{parents?.length === 1 ? "Parent" : "Parents"}</dt>
          <dd>
            {!parents && UNKNOWN}
            {parents?.length === 0 && "none"}
            {parents?.map((parent, i) => (
              <span key={parent}>
                {i > 0 && " and "}
                <a href={`/creatures/${parent}${run ? `?run=${run}` : ""}`}>
                  <code>{short(parent)}</code>
                </a>
              </span>
            ))}
          </dd>
        </div>
        <div>
          <dt>SHA-256</dt>
          <dd>
            <code class="long">{creature.sha256}</code>
          </dd>
        </div>
      </dl>
    </section>
  );
}

function Rows({ rows }: { rows: [name: string, value: string][] }) {
  return rows.map(([name, value]) => (
    <div key={name}>
      <dt>{name}</dt>
      <dd>{value}</dd>
    </div>
  ));
}
