/** Measures, coupling and origin of a creature. */

import * as api from "../api/client";
import type { Creature, Stroke, Units } from "../api/types";
import { useFetched } from "../store/fetch";
import { type Fact, Facts } from "../ui/Facts";
import { Card } from "../ui/Page";
import { type Group, couplingRows, groupsOf, originOf } from "./facts";
import { text } from "./text";
import { RealFields, useReal } from "./RealFields";
import { number } from "../ui/format";

export function FactsCard({ creature }: { creature: Creature }) {
  // A creature without a stroke has no numbers of one.
  const { value: stroke } = useFetched(() => api.readStroke(creature.sha256), [creature.sha256]);
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
            <Facts kind="rows" of={rows.map(written)} />
          </div>
        ))}
        {stroke && <PhysicalUnits {...{ creature, stroke }} />}
      </div>
    </Card>
  );
}

/** A hash is written as code. */
const written = ([name, value]: Group["rows"][0]): Fact => [
  name,
  name === text.sha ? <code class="long">{value}</code> : value,
];

/** A creature in physical units, once its real length and the period of its stroke are given. */
function PhysicalUnits({ creature, stroke }: { creature: Creature; stroke: Stroke }) {
  const viscosity = creature.identity.world.viscosity as number;
  const real = useReal({ cells: stroke.length, steps: stroke.period, viscosity });
  const scales = real.problem === null && real.units?.scales;
  return (
    <div class="physical">
      <h3>{text.physical}</h3>
      <RealFields {...real} />
      {scales && <Facts kind="rows" of={physicalRows(creature, scales)} />}
      {!real.typed.length && !real.typed.period && <p class="quiet small">{text.physicalHint}</p>}
    </div>
  );
}

export function physicalRows(
  { measured }: Creature,
  { cell, step, viscosity, fluid, ...one }: NonNullable<Units["scales"]>,
): [name: string, value: string][] {
  const { speed, reynolds } = (measured?.measures ?? {}) as { speed?: number; reynolds?: number };
  const rows: [string, string][] = [];
  if (speed !== undefined) rows.push([text.realSpeed, shown(speed * one.speed, "m/s")]);
  if (reynolds !== undefined) rows.push([text.nodeSpeed, shown(reynolds * one.node_speed, "m/s")]);
  rows.push([text.realViscosity, `${number(viscosity * 1e6)} mm²/s, ${fluid}`]);
  rows.push([text.realCell, shown(cell, "m")], [text.realStep, shown(step, "s")]);
  return rows;
}

const PREFIXES: [scale: number, prefix: string][] = [
  [1, ""],
  [1e-3, "m"],
  [1e-6, "µ"],
  [1e-9, "n"],
];

/** A quantity with a prefix, such as `270 µm/s`. */
export function shown(value: number, unit: string): string {
  if (value === 0) return `0 ${unit}`;
  const fits = ([scale]: [number, string]) => Math.abs(value) >= 0.9995 * scale;
  const [scale, prefix] = PREFIXES.find(fits) ?? PREFIXES.at(-1)!;
  return `${number(value / scale)} ${prefix}${unit}`;
}
