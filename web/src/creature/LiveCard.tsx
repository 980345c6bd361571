/** Let a creature swim on in this browser, in water that visitors change. */

import { useEffect, useMemo, useState } from "preact/hooks";
import { messageOf } from "../api/problem";
import { decodeEvaluation } from "../decode/evaluation";
import type { FieldName } from "../replay/fields";
import { text as replayText } from "../replay/text";
import { Live, type Push } from "../simulate/live";
import { isInstalled } from "../simulate/source";
import { usePolled } from "../store/polling";
import { number } from "../ui/format";
import { Segments } from "../ui/Select";
import { CheckCard } from "./CheckCard";
import { LiveStage } from "./LiveStage";
import { text } from "./text";

const FIELDS = [
  ["vorticity", replayText.fields.vorticity],
  ["speed", replayText.fields.speed],
  ["dye", text.dye],
] as const;
/** Of the slider of the stroke's speed. */
const SPEEDS = [0.25, 2] as const;
/** Viscosities of the slider, whose values are powers of 10. */
const RANGE = [-2, 0] as const;
/** A push beside the creature. */
const STIR: Push = { away: [0, 6], velocity: [0.05, -0.05] };

interface Props {
  /** Read the inputs of the evaluation; null while they are prepared. */
  readInputs: () => Promise<ArrayBuffer | null>;
}

export function LiveCard({ readInputs }: Props) {
  const [on, setOn] = useState(false);
  const { value: inputs, note, error } = usePolled(on ? readInputs : null, [on]);
  const [live, setLive] = useState<Live | null>(null);
  const [failed, setFailed] = useState<string | null>(null);
  const fail = (reason: unknown) => {
    setFailed(messageOf(reason));
    setOn(false);
  };
  useEffect(() => {
    if (!inputs) return;
    let begun: Live | null = null;
    let active = true;
    begin(inputs)
      .then((found) => {
        begun = found;
        if (active) setLive(found);
        else found.end();
      })
      .catch((reason) => active && fail(reason));
    return () => {
      active = false;
      begun?.end();
      setLive(null);
    };
  }, [inputs]);
  const start = () => {
    setFailed(null);
    setOn(!on);
  };
  if (!isInstalled) return null;
  return (
    <CheckCard
      {...{ note }}
      error={error ?? failed}
      name="live"
      title={text.live}
      verdict={null}
      button={on ? text.stopLive : text.startLive}
      onStart={start}
      running={on && !live ? text.verifying(0) : null}
    >
      {!on && <p class="quiet small">{text.liveAbout}</p>}
      {live && <LiveView live={live} onFail={fail} />}
    </CheckCard>
  );
}

async function begin(inputs: ArrayBuffer): Promise<Live> {
  const { uncovered } = decodeEvaluation(inputs);
  if (uncovered !== null) throw new Error(text.notLive(uncovered));
  return Live.begin(inputs);
}

function LiveView({ live, onFail }: { live: Live; onFail: (reason: unknown) => void }) {
  const [viscosity, setViscosity] = useState(live.stage.viscosity);
  const [speed, setSpeed] = useState(1);
  const [field, setField] = useState<FieldName | "dye">("vorticity");
  const pushes = useMemo<Push[]>(() => [], [live]);
  return (
    <>
      <LiveStage {...{ live, viscosity, speed, field, pushes, onFail }} />
      <div class="row">
        <Segments label={replayText.field} choices={FIELDS} value={field} onSelect={setField} />
        <Slider
          title={text.viscosity(number(viscosity, 2))}
          {...{ range: RANGE, step: 0.05, value: Math.log10(viscosity), shown: viscosity }}
          onChange={(power) => setViscosity(10 ** power)}
        />
        <Slider
          title={text.strokeSpeed(number(speed, 2))}
          {...{ range: SPEEDS, step: 0.25, value: speed, shown: speed }}
          onChange={setSpeed}
        />
        <button onClick={() => pushes.push(STIR)}>{text.stir}</button>
      </div>
    </>
  );
}

interface SliderProps {
  title: string;
  range: readonly [low: number, high: number];
  step: number;
  value: number;
  /** The value that screen readers say. */
  shown: number;
  onChange: (value: number) => void;
}

function Slider({ title, range: [min, max], step, value, shown, onChange }: SliderProps) {
  return (
    <label class="row">
      {title}
      <input
        {...{ type: "range", min, max, step, value }}
        aria-valuetext={number(shown, 2)}
        onInput={({ currentTarget }) => onChange(currentTarget.valueAsNumber)}
      />
    </label>
  );
}
