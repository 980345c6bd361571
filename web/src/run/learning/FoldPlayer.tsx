/** A player for a filament that folds over its picture, with pictures of its moments. */

import { useMemo, useState } from "preact/hooks";
import type { Target } from "../../api/types";
import type { Replay } from "../../decode/replay";
import { prefersStillness, useTheme } from "../../ui/theme";
import { CanvasStage } from "../../replay/CanvasStage";
import { useClock } from "../../replay/clock";
import { StepRange } from "../../replay/Transport";
import { type Fold, drawFold, pictureOf } from "./fold";
import { chainsOf } from "../../replay/motion";
import { text } from "./text";

/** Seconds of playback, and of rest at the end. */
const [LIFE_S, REST_S] = [4, 1.5];
/** Shares of the simulation that are shown as pictures. */
const MOMENTS = [0, 0.1, 0.4, 1];

const INK = {
  light: { body: "#12222c", halo: "rgb(255 255 255 / 0.7)", picture: [214, 106, 42] },
  dark: { body: "#fdf8ec", halo: "rgb(4 10 14 / 0.6)", picture: [226, 132, 66] },
};

export function FoldPlayer({ replay, target }: { replay: Replay; target: Target }) {
  const { frames, every, steps } = replay.header;
  const last = frames - 1;
  const theme = useTheme();
  const [playing, setPlaying] = useState(() => !prefersStillness());
  const [time, setTime] = useState(() => (prefersStillness() ? last : 0));
  const [shown, setShown] = useState(0.6);
  useClock(playing, (seconds) => {
    const whole = last * (1 + REST_S / LIFE_S);
    setTime((now) => (now + (seconds * last) / LIFE_S) % Math.max(1, whole));
  });
  const fold = useMemo((): Fold => {
    const { picture, ...ink } = INK[theme];
    const chains = chainsOf(replay.header.edges);
    return { replay, target, chains, picture: pictureOf(target, picture), shown, ink };
  }, [replay, target, theme, shown]);
  const moment = Math.min(last, time);
  const scrub = (value: number) => {
    setPlaying(false);
    setTime(value);
  };
  return (
    <div class="fold-player">
      <Still fold={fold} time={moment} name={text.filamentFor(target.name)} />
      <div class="row">
        <button onClick={() => setPlaying(!playing)}>{playing ? text.pause : text.play}</button>
        <StepRange time={moment} {...{ last, every, steps }} onScrub={scrub} />
        <label class="compact">
          {text.picture}
          <input
            type="range"
            min="0"
            max="1"
            step="0.05"
            value={shown}
            onInput={(event) => setShown(event.currentTarget.valueAsNumber)}
          />
        </label>
      </div>
      <Moments fold={fold} onChoose={(share) => scrub(share * last)} />
    </div>
  );
}

function Moments({ fold, onChoose }: { fold: Fold; onChoose: (share: number) => void }) {
  const { frames, steps } = fold.replay.header;
  return (
    <ol class="fold-moments" aria-label={text.moments}>
      {MOMENTS.map((share) => (
        <li key={share}>
          <button class="plain" onClick={() => onChoose(share)}>
            <Still
              fold={fold}
              time={share * (frames - 1)}
              name={text.afterSteps(Math.round(share * steps))}
            />
            <span class="small quiet">{text.step(Math.round(share * steps))}</span>
          </button>
        </li>
      ))}
    </ol>
  );
}

function Still({ fold, time, name }: { fold: Fold; time: number; name: string }) {
  return (
    <CanvasStage
      size={fold.replay.header.size}
      label={name}
      draw={(canvas, size) => drawFold(canvas, size, fold, time)}
      inputs={[fold, time]}
    />
  );
}
