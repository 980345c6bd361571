/** Replays to watch, one or several side by side: play, pause, scrub, speed. */

import type { ComponentChildren } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Replay } from "../../frames/replay";
import { useSize } from "../canvas";
import { css, diverging } from "../colours";
import { number } from "../format";
import { prefersStillness, useTheme } from "../theme";
import { useClock, useSpaceBar } from "./clock";
import { FluidPainter, strongest } from "./fluid";
import { chainsOf } from "./motion";
import { drawScene, wayOf } from "./scene";

const SPEEDS = [0.25, 0.5, 1, 2, 4, 8];
/** Steps of the simulation in a second at speed 1. */
const PACE = 40;

/** A replay, and what it is called where it is not alone. */
export interface Film {
  replay: Replay;
  name?: ComponentChildren;
}

/** Films of one task: equally long, in one clock and on one scale of colours. */
export function ReplayPlayer({ films }: { films: Film[] }) {
  const { frames, every, steps } = films[0]!.replay.header;
  const theme = useTheme();
  const strength = useMemo(() => Math.max(...films.map(({ replay }) => strongest(replay))), [films]);
  const [playing, setPlaying] = useState(() => !prefersStillness());
  const [speed, setSpeed] = useState(1);
  const [follow, setFollow] = useState(true);
  const [time, setTime] = useState(0);
  const toggle = () => setPlaying((now) => !now);
  useClock(playing, (seconds) => {
    setTime((now) => (now + (seconds * speed * PACE) / every) % Math.max(1, frames - 1));
  });
  useSpaceBar(toggle);
  const scrub = (moment: number) => {
    setPlaying(false);
    setTime(moment);
  };
  return (
    <div class="player">
      <div class="stages">
        {films.map(({ replay, name }, i) => (
          <figure key={i}>
            <Stage {...{ replay, theme, strength, follow, time }} onClick={toggle} />
            {name && <figcaption>{name}</figcaption>}
          </figure>
        ))}
      </div>
      <div class="controls">
        <PlayButton playing={playing} onClick={toggle} />
        <Scrubber time={time} last={frames - 1} every={every} steps={steps} onScrub={scrub} />
        <Speed value={speed} onChange={setSpeed} />
        <label class="compact">
          <input
            type="checkbox"
            checked={follow}
            onChange={(event) => setFollow(event.currentTarget.checked)}
          />
          Follow
        </label>
      </div>
      {strength > 0 && <VorticityLegend strength={strength} theme={theme} />}
    </div>
  );
}

interface StageProps {
  replay: Replay;
  theme: "light" | "dark";
  strength: number;
  follow: boolean;
  time: number;
  onClick: () => void;
}

function Stage({ replay, theme, strength, follow, time, onClick }: StageProps) {
  const stage = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const size = useSize(stage);
  const [width, height] = replay.header.size;
  const scene = useMemo(() => {
    const painter = new FluidPainter(replay, theme, strength);
    const chains = chainsOf(replay.header.edges);
    return { replay, painter, chains, way: wayOf(replay), follow, theme };
  }, [replay, theme, strength, follow]);
  useEffect(() => {
    if (size.width > 0) drawScene(canvas.current!, size, scene, time);
  }, [size, scene, time]);
  return (
    <div
      ref={stage}
      class="stage"
      style={{ aspectRatio: `${width} / ${height}`, maxWidth: `calc(76vh * ${width / height})` }}
    >
      <canvas
        ref={canvas}
        role="img"
        aria-label="The creature swimming; colours show the fluid's vorticity."
        onClick={onClick}
      />
    </div>
  );
}

function PlayButton({ playing, onClick }: { playing: boolean; onClick: () => void }) {
  return (
    <button class="round" onClick={onClick} title="Space bar">
      <span class="unseen">{playing ? "Pause" : "Play"}</span>
      <svg viewBox="0 0 16 16" aria-hidden="true">
        <path d={playing ? "M4 2.5h3v11H4zM9 2.5h3v11H9z" : "M4.5 2.5v11l9-5.5z"} />
      </svg>
    </button>
  );
}

interface ScrubberProps {
  time: number;
  last: number;
  every: number;
  steps: number;
  onScrub: (time: number) => void;
}

function Scrubber({ time, last, every, steps, onScrub }: ScrubberProps) {
  const step = Math.min(steps, Math.round(time * every));
  return (
    <>
      <input
        type="range"
        class="scrub"
        aria-label="Moment of the replay"
        aria-valuetext={`step ${step} of ${steps}`}
        min="0"
        max={last}
        step="any"
        value={time}
        onInput={(event) => onScrub(event.currentTarget.valueAsNumber)}
      />
      <output class="moment">
        {step} / {steps}
      </output>
    </>
  );
}

function Speed({ value, onChange }: { value: number; onChange: (speed: number) => void }) {
  return (
    <label class="compact">
      Speed
      <select
        value={String(value)}
        onChange={(event) => onChange(Number(event.currentTarget.value))}
      >
        {SPEEDS.map((speed) => (
          <option key={speed} value={String(speed)}>
            {speed} ×
          </option>
        ))}
      </select>
    </label>
  );
}

function VorticityLegend({ strength, theme }: { strength: number; theme: "light" | "dark" }) {
  const stops = Array.from({ length: 17 }, (_, i) => css(diverging(i / 8 - 1, theme)));
  const top = number(strength, 2);
  return (
    <div class="legend" role="img" aria-label={`Vorticity from −${top} to ${top} per step`}>
      <span class="legend-name">Vorticity (1/step)</span>
      <span class="legend-bar" style={{ background: `linear-gradient(90deg, ${stops})` }} />
      <span class="legend-numbers">
        <span>−{top}</span>
        <span>0</span>
        <span>{top}</span>
      </span>
    </div>
  );
}
