/** Measures, coupling and origin of a creature. */

import * as api from "../api/client";
import type { Creature } from "../api/types";
import { useFetched } from "../store/fetch";
import { Card } from "../ui/Page";
import { Term } from "../ui/Term";
import { type Group, couplingRows, groupsOf, originOf } from "./facts";
import { PhysicalUnits } from "./PhysicalUnits";
import { strokeOf } from "./physical";
import { text } from "./text";

export function FactsCard({ creature }: { creature: Creature }) {
  const { value: stroke } = useFetched(async () => {
    return strokeOf(creature) === null ? null : api.readStroke(creature.sha256);
  }, [creature.sha256]);
  const groups: Group[] = [
    ...groupsOf(creature, stroke?.sperm ?? null),
    { title: text.coupling, rows: couplingRows(creature) },
    { title: text.origin, rows: originOf(creature) },
  ];
  return (
    <Card id="facts" title={text.facts} kind="facts-card">
      <div class="facts-columns">
        {groups.map(({ title, rows }) => (
          <div key={title} hidden={rows.length === 0}>
            <h3>{title}</h3>
            <dl class="rows">
              {rows.map(([name, value]) => (
                <div key={name}>
                  <dt>
                    <Term name={name} />
                  </dt>
                  <dd>{name === text.sha ? <code class="long">{value}</code> : value}</dd>
                </div>
              ))}
            </dl>
          </div>
        ))}
        <PhysicalUnits creature={creature} />
      </div>
    </Card>
  );
}
