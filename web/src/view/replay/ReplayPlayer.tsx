/** A replay to watch: play, pause, scrub, speed. */

import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Replay } from "../../frames/replay";
import { useSize } from "../canvas";
import { css, diverging } from "../colours";
import { number } from "../format";
import { prefersStillness, useTheme } from "../theme";
import { FluidPainter, strongest } from "./fluid";
import { chainsOf } from "./motion";
import { drawScene, wayOf } from "./scene";

const SPEEDS = [0.25, 0.5, 1, 2, 4, 8];
/** Steps of the simulation in a second at speed 1. */
const PACE = 40;

export function ReplayPlayer({ replay }: { replay: Replay }) {
  const { frames, every, steps, size: world } = replay.header;
  const stage = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const size = useSize(stage);
  const theme = useTheme();
  const [playing, setPlaying] = useState(() => !prefersStillness());
  const [speed, setSpeed] = useState(1);
  const [follow, setFollow] = useState(true);
  const [time, setTime] = useState(0);
  const strength = useMemo(() => strongest(replay), [replay]);
  const scene = useMemo(() => {
    const painter = new FluidPainter(replay, theme, strength);
    const chains = chainsOf(replay.header.edges);
    return { replay, painter, chains, way: wayOf(replay), follow, theme };
  }, [replay, theme, strength, follow]);

  useClock(playing, (seconds) => {
    setTime((now) => (now + (seconds * speed * PACE) / every) % Math.max(1, frames - 1));
  });
  useSpaceBar(() => setPlaying((now) => !now));
  useEffect(() => {
    if (size.width > 0) drawScene(canvas.current!, size, scene, time);
  }, [size, scene, time]);

  const step = Math.min(steps, Math.round(time * every));
  return (
    <div class="player">
      <div
        ref={stage}
        class="stage"
        style={{
          aspectRatio: `${world[0]} / ${world[1]}`,
          maxWidth: `calc(76vh * ${world[0] / world[1]})`,
        }}
      >
        <canvas
          ref={canvas}
          role="img"
          aria-label="The creature swimming; colours show the fluid's vorticity."
          onClick={() => setPlaying(!playing)}
        />
      </div>
      <div class="controls">
        <button
          class="round"
          onClick={() => setPlaying(!playing)}
          aria-label={playing ? "Pause" : "Play"}
          title="Space bar"
        >
          {playing ? <PauseSign /> : <PlaySign />}
        </button>
        <input
          type="range"
          class="scrub"
          aria-label="Moment of the replay"
          aria-valuetext={`step ${step} of ${steps}`}
          min="0"
          max={frames - 1}
          step="any"
          value={time}
          onInput={(event) => {
            setPlaying(false);
            setTime(event.currentTarget.valueAsNumber);
          }}
        />
        <output class="moment">
          {step} / {steps}
        </output>
        <label class="compact">
          Speed
          <select
            value={String(speed)}
            onChange={(event) => setSpeed(Number(event.currentTarget.value))}
          >
            {SPEEDS.map((value) => (
              <option key={value} value={String(value)}>
                {value} ×
              </option>
            ))}
          </select>
        </label>
        <label class="compact">
          <input
            type="checkbox"
            checked={follow}
            onChange={(event) => setFollow(event.currentTarget.checked)}
          />
          Follow
        </label>
      </div>
      <VorticityLegend strength={strength} theme={theme} />
    </div>
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

/** Calls back with the seconds since the last frame of the screen, while it runs. */
function useClock(running: boolean, tick: (seconds: number) => void): void {
  const latest = useRef(tick);
  latest.current = tick;
  useEffect(() => {
    if (!running) return;
    let last = performance.now();
    let frame = requestAnimationFrame(function step(now) {
      // A tab that was hidden goes on where it was.
      latest.current(Math.min(0.1, Math.max(0, now - last) / 1000));
      last = now;
      frame = requestAnimationFrame(step);
    });
    return () => cancelAnimationFrame(frame);
  }, [running]);
}

function useSpaceBar(toggle: () => void): void {
  useEffect(() => {
    const press = (event: KeyboardEvent) => {
      const target = event.target as HTMLElement;
      const busy = target.closest("button, select, a, textarea, summary, input:not([type=range])");
      if (event.key !== " " || busy) return;
      event.preventDefault();
      toggle();
    };
    window.addEventListener("keydown", press);
    return () => window.removeEventListener("keydown", press);
  }, []);
}

function PlaySign() {
  return (
    <svg viewBox="0 0 16 16" aria-hidden="true">
      <path d="M4.5 2.5v11l9-5.5z" />
    </svg>
  );
}

function PauseSign() {
  return (
    <svg viewBox="0 0 16 16" aria-hidden="true">
      <path d="M4 2.5h3v11H4zM9 2.5h3v11H9z" />
    </svg>
  );
}
