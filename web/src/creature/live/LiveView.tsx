/** Live water with what changes it: its field, viscosity, the stroke, pushes, pulls and other creatures. */

import type { ComponentChildren } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { decodeEvaluation } from "../../decode/evaluation";
import type { FieldName } from "../../replay/fields";
import { text as replayText } from "../../replay/text";
import type { Live, Push } from "../../simulate/simulator";
import { usePolled } from "../../store/polling";
import { number, shortId } from "../../ui/format";
import { Segments, Slider } from "../../ui/Select";
import { LiveStage } from "./LiveStage";
import { text } from "./text";
import { type Wishes, noWishes } from "./touch";

const FIELDS = [
  ["vorticity", replayText.fields.vorticity],
  ["speed", replayText.fields.speed],
  ["dye", text.dye],
] as const;
/** The buttons push the water beside the creature, and pull its first node for a while. */
const PUSH: Push = { away: [0, 6], velocity: [0.05, -0.05] };
const PULL = { node: 0, away: [0, 10] as [number, number] };
const PULL_MS = 1000;

/** Other creatures that may join. */
export interface Others {
  /** Read the inputs of the evaluation of a creature; null while they are prepared. */
  readInputs: (creature: string) => Promise<ArrayBuffer | null>;
  /** The controls that pick a creature. */
  pick: (onPick: (creature: string) => void) => ComponentChildren;
}

interface Props {
  live: Live;
  /** Null where no other creature can be read. */
  others: Others | null;
  onFail: (reason: unknown) => void;
}

export function LiveView({ live, others, onFail }: Props) {
  const [viscosity, setViscosity] = useState(live.stage.viscosity);
  const [speed, setSpeed] = useState(1);
  const [field, setField] = useState<FieldName | "dye">("vorticity");
  const wishes = useMemo(noWishes, [live]);
  const { note, pick, refuse } = useJoining(others, wishes);
  return (
    <>
      <LiveStage {...{ live, viscosity, speed, field, wishes, onFail }} onRefuse={refuse} />
      <div class="row">
        <Segments label={replayText.field} choices={FIELDS} value={field} onSelect={setField} />
        {/* Its values are powers of 10. */}
        <Slider
          title={text.viscosity(number(viscosity, 2))}
          {...{ min: -2, max: 0, step: 0.05, value: Math.log10(viscosity) }}
          reading={number(viscosity, 2)}
          onChange={(power) => setViscosity(10 ** power)}
        />
        <Slider
          title={text.strokeSpeed(number(speed, 2))}
          {...{ min: 0.25, max: 2, step: 0.25, value: speed }}
          reading={number(speed, 2)}
          onChange={setSpeed}
        />
        <button onClick={() => wishes.pushes.push(PUSH)}>{text.push}</button>
        <button onClick={() => pullAWhile(wishes)}>{text.pull}</button>
      </div>
      {others && (
        <details class="live-others">
          <summary>{text.others}</summary>
          {others.pick(pick)}
        </details>
      )}
      <p class="quiet small" role="status">
        {note}
      </p>
    </>
  );
}

function pullAWhile(wishes: Wishes): void {
  wishes.pull = PULL;
  setTimeout(() => {
    if (wishes.pull === PULL) wishes.pull = null;
  }, PULL_MS);
}

/** Let a picked creature join once its inputs are loaded, with a note on the progress. */
function useJoining(others: Others | null, wishes: Wishes) {
  const [picked, setPicked] = useState<string | null>(null);
  const [note, setNote] = useState("");
  const name = useRef("");
  const { value, error } = usePolled(picked && others ? () => others.readInputs(picked) : null, [picked]);
  useEffect(() => {
    if (!value) return;
    const { uncovered } = decodeEvaluation(value);
    if (uncovered === null) wishes.joining.push(value);
    setNote(uncovered === null ? text.joined(name.current) : text.uncovered(name.current, uncovered));
    setPicked(null);
  }, [value]);
  useEffect(() => {
    if (!error) return;
    setNote(text.refused(name.current, error));
    setPicked(null); // It can be picked again.
  }, [error]);
  return {
    note,
    pick: (creature: string) => {
      name.current = shortId(creature);
      setNote(text.joining(name.current));
      setPicked(creature);
    },
    refuse: (reason: string) => setNote(text.refused(name.current, reason)),
  };
}
