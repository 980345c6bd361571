/** Replays to watch, one or several side by side: play, pause, step, scrub, speed. */

import type { ComponentChildren } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Replay } from "../decode/replay";
import { useSize } from "../ui/canvas";
import { useTheme } from "../ui/theme";
import { useClock, useKeys } from "./clock";
import { FieldLegend, LookChoice, Speed } from "./Controls";
import { type Field, fieldOf, fieldsOf } from "./fields";
import { FluidPainter } from "./fluid";
import { type ReplayView, DEFAULT_VIEW } from "./look";
import { type Moment, newMoment, useMoment } from "./moment";
import { chainsOf } from "./motion";
import { drawScene, wayOf } from "./scene";
import { Tracers } from "./tracers";
import "./replay.css";

/** Steps of the simulation in a second at speed 1. */
const FRAMES_PER_SECOND = 40;

/** A replay, and what it is called where it is not alone. */
export interface Film {
  replay: Replay;
  name?: ComponentChildren;
}

interface Props {
  films: Film[];
  /** Left out, the player keeps its own. */
  moment?: Moment;
  look?: ReplayView;
  onLook?: (change: Partial<ReplayView>) => void;
}

/** Films of one task: equally long, in one clock and on one scale of colours. */
export function ReplayPlayer({ films, ...given }: Props) {
  const { frames, every, steps } = films[0]!.replay.header;
  const last = frames - 1;
  const theme = useTheme();
  const [own, setOwn] = useState(DEFAULT_VIEW);
  const look = given.look ?? own;
  const change = given.onLook ?? ((part) => setOwn((old) => ({ ...old, ...part })));
  const moment = useMoment(useMemo(() => given.moment ?? newMoment(), [given.moment]));
  const names = useMemo(() => fieldsOf(films.map(({ replay }) => replay)), [films]);
  const name = names.includes(look.field!) ? look.field! : names[0]!;
  const field = useMemo(() => {
    return fieldOf(
      name,
      films.map(({ replay }) => replay),
      theme,
    );
  }, [films, name, theme]);
  useClock(moment.playing, (seconds) => {
    moment.move((moment.time + (seconds * look.speed * FRAMES_PER_SECOND) / every) % Math.max(1, last));
  });
  const toggle = () => moment.play(!moment.playing);
  const step = (by: 1 | -1) => moment.step(by, last);
  const player = useRef<HTMLDivElement>(null);
  useKeys(player, {
    " ": toggle,
    ",": () => step(-1),
    ".": () => step(1),
    ArrowLeft: () => step(-1),
    ArrowRight: () => step(1),
    Home: () => moment.scrub(0),
    End: () => moment.scrub(last),
  });
  const tracing = look.tracers && films.every(({ replay }) => replay.drive);
  return (
    <div ref={player} class="player" role="group" aria-label="Replay player" tabIndex={-1}>
      <div class="stages">
        {films.map(({ replay, name }, i) => (
          <figure key={i}>
            <Stage
              {...{ replay, theme, field, tracing }}
              follow={look.follow}
              time={moment.time}
              onClick={toggle}
            />
            {name && <figcaption>{name}</figcaption>}
          </figure>
        ))}
      </div>
      <div class="controls">
        <Button
          label="One frame back"
          keys=", ArrowLeft"
          small
          path="M11 3v10L4.5 8zM3 3h1.8v10H3z"
          onClick={() => step(-1)}
        />
        <Button
          label={moment.playing ? "Pause" : "Play"}
          keys="Space"
          path={moment.playing ? "M4 2.5h3v11H4zM9 2.5h3v11H9z" : "M4.5 2.5v11l9-5.5z"}
          onClick={toggle}
        />
        <Button
          label="One frame on"
          keys=". ArrowRight"
          small
          path="M5 3v10l6.5-5zM11.2 3H13v10h-1.8z"
          onClick={() => step(1)}
        />
        <Scrubber time={moment.time} {...{ last, every, steps }} onScrub={(time) => moment.scrub(time)} />
        <Speed value={look.speed} onChange={(speed) => change({ speed })} />
      </div>
      <LookChoice {...{ names, name, look, change }} flows={films.every(({ replay }) => replay.drive)} />
      {field && <FieldLegend field={field} />}
    </div>
  );
}

interface StageProps {
  replay: Replay;
  theme: "light" | "dark";
  field: Field | null;
  tracing: boolean;
  follow: boolean;
  time: number;
  onClick: () => void;
}

function Stage({ replay, theme, field, tracing, follow, time, onClick }: StageProps) {
  const stage = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const size = useSize(stage);
  const [width, height] = replay.header.size;
  const tracers = useMemo(() => (tracing ? new Tracers(replay) : null), [replay, tracing]);
  const scene = useMemo(() => {
    const painter = field && new FluidPainter(replay, field);
    const chains = chainsOf(replay.header.edges);
    return { replay, painter, chains, way: wayOf(replay), follow, theme: field?.ground ?? theme };
  }, [replay, theme, field, follow]);
  useEffect(() => {
    if (size.width > 0) drawScene(canvas.current!, size, { ...scene, tracers }, time);
  }, [size, scene, tracers, time]);
  const shown = field ? `colours show the fluid's ${field.title.toLowerCase()}` : "the fluid is left blank";
  return (
    <div
      ref={stage}
      class={`stage ${field ? "" : "blank"}`}
      style={{ aspectRatio: `${width} / ${height}`, maxWidth: `calc(70vh * ${width / height})` }}
    >
      <canvas
        ref={canvas}
        role="img"
        aria-label={`The creature swimming; ${shown}${tracing ? ", tracers its paths" : ""}.`}
        onClick={onClick}
      />
    </div>
  );
}

interface ButtonProps {
  label: string;
  /** As `aria-keyshortcuts` has them. */
  keys: string;
  small?: boolean;
  path: string;
  onClick: () => void;
}

const KEY_NAMES: Record<string, string> = { Space: "space bar", ArrowLeft: "←", ArrowRight: "→" };

function Button({ label, keys, small, path, onClick }: ButtonProps) {
  const named = keys.split(" ").map((key) => KEY_NAMES[key] ?? key);
  return (
    <button
      class={`round ${small ? "small-round" : ""}`}
      onClick={onClick}
      aria-keyshortcuts={keys}
      title={`${label} (${named.join(" or ")})`}
    >
      <span class="unseen">{label}</span>
      <svg viewBox="0 0 16 16" aria-hidden="true">
        <path d={path} />
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
        aria-keyshortcuts="Home End"
        title="Home and End lead to the first and the last frame"
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
