/** A creature in physical units, once its real length and the period of its stroke are given. */

import type { Creature } from "../api/types";
import { usePoseStream } from "../store/poses";
import { RealFields, useTyped } from "./real/RealFields";
import { problemOf, realOf } from "./real/quantity";
import { physicalRows, strokeOf } from "./physical";
import { text } from "./text";

export function PhysicalUnits({ creature }: { creature: Creature }) {
  const [typed, change] = useTyped();
  const { stream } = usePoseStream(creature.sha256);
  const steps = strokeOf(creature);
  if (steps === null || !stream) return null;
  const real = realOf(typed);
  return (
    <div class="physical">
      <h3>{text.physical}</h3>
      <RealFields typed={typed} onChange={change} />
      {real && (
        <dl class="rows">
          {physicalRows(creature, real, stream.header.length, steps).map(([name, value]) => (
            <div key={name}>
              <dt>{name}</dt>
              <dd>{value}</dd>
            </div>
          ))}
        </dl>
      )}
      {!real && !problemOf(typed) && <p class="quiet small">{text.physicalHint}</p>}
    </div>
  );
}
