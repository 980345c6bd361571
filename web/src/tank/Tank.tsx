/** The tank: the best and the most different creatures, swimming as they were recorded. */

import type { RefObject } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Tank as Tankful, Run, Tank } from "../api/types";
import type { PoseStream } from "../decode/poses";
import { useClock } from "../replay/clock";
import { type ReadBatch, type Visible, readTankBatch, usePoses } from "../store/poses";
import { navigate } from "../store/router";
import { useStore } from "../store/store";
import { useTank } from "../store/tank";
import { type Size, prefersReducedMotion, px, useOnScreen, useSize } from "../ui/canvas";
import { labelOf, number, duration } from "../ui/format";
import { drawTank, drawTrails } from "./drawTank";
import { openExample, readExampleBatch, useExamples } from "./examples";
import { type Swimmer, advance, nearestScale, swimmerAt, withSwimmers } from "./swimmers";
import { text } from "./text";
import "./tank.css";
import { timeOf } from "../run/RunStatus";

/** A phone shows fewer creatures. */
const [MOST, ON_A_PHONE, PHONE] = [60, 30, 640];
/** Frames until trails are drawn again. */
const TRAIL_FRAMES = 6;

export function Tank() {
  const box = useRef<HTMLElement>(null);
  const size = useSize(box);
  const narrow = window.innerWidth < PHONE;
  const { value: tank, error } = useTank(narrow ? ON_A_PHONE : MOST);
  const isEmpty = tank?.swimmers.length === 0;
  const examples = useExamples(isEmpty);
  const shown = isEmpty ? examples : tank;
  const source = isEmpty ? EXAMPLES : ELITES;
  return (
    <section ref={box} class="tank" aria-label={text.label(shown?.swimmers.length ?? 0)}>
      {shown && shown.swimmers.length > 0 && <Water tank={shown} size={size} {...source} />}
      {isEmpty && <Begun examples={examples !== null} />}
      {error && <p class="tank-note">{error}</p>}
      {tank && <TankLine tank={tank} />}
    </section>
  );
}

/** A source of creatures: it reads their motions and opens one. */
interface Source {
  readBatch: ReadBatch<Visible>;
  onOpen: (creature: string) => void;
}

const ELITES: Source = {
  readBatch: readTankBatch,
  onOpen: (creature) => navigate(`/creatures/${creature}`),
};
const EXAMPLES: Source = { readBatch: readExampleBatch, onOpen: openExample };

interface WaterProps extends Source {
  tank: Tankful;
  size: Size;
}

function Water({ tank, size, readBatch, onOpen }: WaterProps) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const trails = useRef<HTMLCanvasElement>(null);
  const [pointed, setPointed] = useState<string | null>(null);
  const [paused, setPaused] = useState(prefersReducedMotion);
  const poses = usePoses(readBatch, tank.swimmers, false);
  const scene = useScene(tank, poses, size, { canvas, trails }, pointed, paused);
  const open = (creature: string | null) => creature && onOpen(creature);
  const under = (event: MouseEvent) => {
    const { left, top } = canvas.current!.getBoundingClientRect();
    const at = swimmerAt(
      scene.current.swimmers,
      [event.clientX - left, event.clientY - top],
      scene.current.nearest,
    );
    return at?.creature ?? null;
  };
  const press = (event: KeyboardEvent) => {
    const way = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (event.key === "Enter") open(pointed);
    else if (event.key === "Escape") setPointed(null);
    else if (way) setPointed(next(tank, pointed, way));
    else return;
    event.preventDefault();
  };
  return (
    <>
      <div
        class={`water ${pointed ? "over" : ""}`}
        tabIndex={0}
        role="application"
        aria-label={text.label(tank.swimmers.length)}
        aria-describedby="tank-pointed"
        onPointerMove={(event) => setPointed(under(event))}
        onPointerLeave={() => setPointed(null)}
        onClick={(event) => open(under(event) ?? pointed)}
        onKeyDown={press}
        onBlur={() => setPointed(null)}
      >
        <canvas ref={trails} style={px({ ...size })} />
        <canvas ref={canvas} style={px({ ...size })} />
      </div>
      <Pointed tank={tank} creature={pointed} scene={scene} />
      <PauseButton paused={paused} onChange={setPaused} />
    </>
  );
}

function PauseButton({ paused, onChange }: { paused: boolean; onChange: (paused: boolean) => void }) {
  const label = paused ? text.play : text.pause;
  return (
    <button class="tank-pause" aria-label={label} title={label} onClick={() => onChange(!paused)}>
      {paused ? "▶" : "❚❚"}
    </button>
  );
}

/** The creature before or after one, in the order of the server. */
function next({ swimmers }: Tankful, pointed: string | null, way: number): string {
  const at = swimmers.findIndex(({ creature }) => creature === pointed);
  const place = at < 0 ? (way > 0 ? 0 : -1) : at + way;
  return swimmers.at(place % swimmers.length)!.creature;
}

interface Scene {
  swimmers: Swimmer[];
  /** Pixels of a cell for the nearest creatures. */
  nearest: number;
}

/** The swimmers, drawn in every frame unless they are paused or nobody sees them. */
function useScene(
  tank: Tankful,
  poses: ReadonlyMap<string, PoseStream>,
  size: Size,
  { canvas, trails }: Record<"canvas" | "trails", RefObject<HTMLCanvasElement | null>>,
  pointed: string | null,
  paused: boolean,
): RefObject<Scene> & { current: Scene } {
  const scene = useRef<Scene>({ swimmers: [], nearest: 1 });
  const frame = useRef(0);
  const streams = useMemo(
    () => tank.swimmers.flatMap(({ creature }) => poses.get(creature) ?? []),
    [tank, tank.swimmers.filter(({ creature }) => poses.has(creature)).length],
  );
  const draw = () => {
    const { swimmers, nearest } = scene.current;
    if (!canvas.current || size.width === 0) return;
    drawTank(canvas.current, size, swimmers, nearest, pointed);
    if (frame.current++ % TRAIL_FRAMES === 0) drawTrails(trails.current!, size, swimmers);
    if (swimmers.length > 0 && performance.getEntriesByName("tank").length === 0) performance.mark("tank");
  };
  useEffect(() => {
    if (size.width === 0 || streams.length === 0) return;
    const { swimmers } = scene.current;
    const none = swimmers.length === 0;
    scene.current = {
      swimmers: withSwimmers(swimmers, streams, size, none || paused),
      nearest: nearestScale(streams, size.width),
    };
  }, [streams, size.width > 0]);
  const seen = useOnScreen(canvas);
  useClock(seen && !paused, (seconds) => {
    const { swimmers, nearest } = scene.current;
    scene.current.swimmers = advance(swimmers, seconds, nearest, size);
    draw();
  });
  useEffect(() => {
    frame.current = 0;
    draw();
  });
  return scene;
}

interface PointedProps {
  tank: Tankful;
  creature: string | null;
  scene: { current: Scene };
}

/** The name of the creature that is pointed at, beside it. */
function Pointed({ tank, creature, scene }: PointedProps) {
  const named = tank.swimmers.find((one) => one.creature === creature);
  const run = named && tank.runs.find(({ id }) => id === named.run);
  const at = scene.current.swimmers.find((one) => one.creature === creature)?.position;
  return (
    <p
      id="tank-pointed"
      class="tank-pointed"
      role="status"
      style={at ? px({ left: at[0], top: at[1] }) : undefined}
      hidden={!named}
    >
      {named && (
        <>
          <strong>{text.fitness(number(named.fitness))}</strong>
          <span>{run ? text.born(named.generation, labelOf(run)) : text.example}</span>
        </>
      )}
    </p>
  );
}

/** The note in a tank without elites. */
function Begun({ examples }: { examples: boolean }) {
  const first = useStore(({ runs }) => [...runs.values()].find(({ status }) => status in text.begun));
  const [title, hint] = text.begun[first?.status as "running" | "queued"] ?? text.nothing;
  const reason = first?.waiting_reason ?? (examples ? null : hint);
  return (
    <div class={`tank-note ${examples ? "over-examples" : ""}`}>
      <h2>{title}</h2>
      {reason && <p>{reason}</p>}
      {examples && <p>{text.examples}</p>}
    </div>
  );
}

/** One line over the tank: what evolves, and how far it is. */
function TankLine({ tank }: { tank: Tank }) {
  const runs = useStore((state) => state.runs);
  const running = [...runs.values()].filter(({ status }) => status === "running");
  const first = running.sort((a, b) => b.created_at.localeCompare(a.created_at))[0];
  if (!first && tank.swimmers.length === 0) return null;
  return (
    <p class="tank-line">
      {first ? (
        <Evolving run={first} others={running.length - 1} />
      ) : (
        text.still(tank.swimmers.length, new Set(tank.swimmers.map(({ run }) => run)).size)
      )}
    </p>
  );
}

function Evolving({ run, others }: { run: Run; others: number }) {
  const { generation, generations, evaluations_per_second: rate } = run;
  const facts = [text.progress(generation, generations)];
  if (rate) facts.push(text.rate(number(rate)));
  if (run.eta_seconds !== null && timeOf(run).text !== "–") facts.push(text.left(duration(run.eta_seconds)));
  if (others > 0) facts.push(text.more(others));
  return (
    <>
      <span class="ripple small-ripple" aria-hidden="true" />
      <span>
        <a href={`/runs/${run.id}`}>{labelOf(run)}</a> {text.evolves}
      </span>
      <span class="tank-facts">{facts.join(" · ")}</span>
    </>
  );
}
