/** A player for a filament that folds over its picture, with pictures of its moments. */

import { useMemo, useState } from "preact/hooks";
import type { Target } from "../../api/types";
import type { Replay } from "../../decode/replay";
import { CanvasStage } from "../../replay/CanvasStage";
import { StepRange } from "../../replay/timeControls";
import { useClock } from "../../replay/clock";
import { type Point, BODY_INK, chainsOf, positionsAt } from "../../replay/motion";
import { type Size, prepare, prefersReducedMotion, useTheme } from "../../ui/canvas";
import { text } from "./text";

/** Seconds of playback, and of rest at the end. */
const [PLAY_SECONDS, PAUSE_SECONDS] = [4, 1.5];
/** Shares of the simulation that are shown as pictures. */
const MOMENTS = [0, 0.1, 0.4, 1];

const INK = {
  light: { body: BODY_INK.light, halo: "rgb(255 255 255 / 0.7)", picture: [214, 106, 42] },
  dark: { body: BODY_INK.dark, halo: "rgb(4 10 14 / 0.6)", picture: [226, 132, 66] },
};

export function FoldPlayer({ replay, target }: { replay: Replay; target: Target }) {
  const { frames, every, steps } = replay.header;
  const last = frames - 1;
  const theme = useTheme();
  const [playing, setPlaying] = useState(() => !prefersReducedMotion());
  const [time, setTime] = useState(() => (prefersReducedMotion() ? last : 0));
  const [opacity, setOpacity] = useState(0.6);
  useClock(playing, (seconds) => {
    const whole = last * (1 + PAUSE_SECONDS / PLAY_SECONDS);
    setTime((now) => (now + (seconds * last) / PLAY_SECONDS) % Math.max(1, whole));
  });
  const fold = useMemo((): Fold => {
    const { picture, ...ink } = INK[theme];
    const chains = chainsOf(replay.header.edges);
    return { replay, target, chains, picture: pictureOf(target, picture), opacity, ink };
  }, [replay, target, theme, opacity]);
  const moment = Math.min(last, time);
  const scrub = (value: number) => {
    setPlaying(false);
    setTime(value);
  };
  return (
    <div class="fold-player">
      <MomentPicture fold={fold} time={moment} name={text.filamentFor(target.name)} />
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
            value={opacity}
            onInput={(event) => setOpacity(event.currentTarget.valueAsNumber)}
          />
        </label>
      </div>
      <Moments fold={fold} onSelect={(share) => scrub(share * last)} />
    </div>
  );
}

function Moments({ fold, onSelect }: { fold: Fold; onSelect: (share: number) => void }) {
  const { frames, steps } = fold.replay.header;
  return (
    <ol class="fold-moments" aria-label={text.moments}>
      {MOMENTS.map((share) => (
        <li key={share}>
          <button class="plain" onClick={() => onSelect(share)}>
            <MomentPicture
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

function MomentPicture({ fold, time, name }: { fold: Fold; time: number; name: string }) {
  return (
    <CanvasStage
      size={fold.replay.header.size}
      label={name}
      draw={(canvas, size) => drawFold(canvas, size, fold, time)}
      inputs={[fold, time]}
    />
  );
}

interface Fold {
  replay: Replay;
  picture: OffscreenCanvas;
  target: Target;
  chains: number[][];
  /** Opacity of the picture, from 0 to 1. */
  opacity: number;
  ink: { body: string; halo: string };
}

/** A picture in one colour on a transparent ground. */
export function pictureOf({ width, height, pixels }: Target, rgb: readonly number[]): OffscreenCanvas {
  const canvas = new OffscreenCanvas(width, height);
  const context = canvas.getContext("2d")!;
  const image = context.createImageData(width, height);
  const bytes = atob(pixels);
  for (let i = 0; i < width * height; i++) {
    image.data.set([...rgb, bytes.charCodeAt(i)], 4 * i);
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

/** Place of a picture on the lattice: left, top (upwards), width and height, in cells. */
export function pictureBox(target: Target, world: readonly [number, number]) {
  const scale = target.size / Math.max(target.width, target.height);
  const [width, height] = [Math.round(scale * target.width), Math.round(scale * target.height)];
  const [left, bottom] = [Math.floor((world[0] - width) / 2), Math.floor((world[1] - height) / 2)];
  // The centre of a cell is a whole coordinate.
  return { left: left - 0.5, top: bottom + height - 0.5, width, height };
}

function drawFold(canvas: HTMLCanvasElement, size: Size, fold: Fold, time: number): void {
  const context = prepare(canvas, size);
  const world = fold.replay.header.size;
  const scale = size.width / world[0];
  const screen = ([x, y]: Point): Point => [(x + 0.5) * scale, (world[1] - 0.5 - y) * scale];
  const { left, top, width, height } = pictureBox(fold.target, world);
  context.globalAlpha = fold.opacity;
  context.imageSmoothingQuality = "high";
  context.drawImage(fold.picture, ...screen([left, top]), width * scale, height * scale);
  context.globalAlpha = 1;
  const points = positionsAt(fold.replay, time).map(screen);
  context.lineCap = context.lineJoin = "round";
  for (const [colour, lineWidth] of [
    [fold.ink.halo, Math.max(2.6, 0.9 * scale)],
    [fold.ink.body, Math.max(1.1, 0.45 * scale)],
  ] as const) {
    context.beginPath();
    for (const chain of fold.chains) {
      chain.forEach((node, i) => context[i === 0 ? "moveTo" : "lineTo"](...points[node]!));
    }
    context.strokeStyle = colour;
    context.lineWidth = lineWidth;
    context.stroke();
  }
}
