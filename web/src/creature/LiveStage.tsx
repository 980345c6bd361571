/** The live water around a creature, which pointers push. */

import { useEffect, useRef, useState } from "preact/hooks";
import type { Replay } from "../decode/replay";
import { CanvasStage } from "../replay/CanvasStage";
import { type FieldName, fieldOf } from "../replay/fields";
import { FluidPainter } from "../replay/fluid";
import { drawScene, sceneOf } from "../replay/scene";
import type { Live, Push } from "../simulate/live";
import type { Frame, Stage } from "../simulate/swim";
import { useTheme } from "../ui/canvas";
import { Dye } from "./dye";
import { text } from "./text";

/** Frames in a stroke. */
const FRAMES = 90;
/** The fastest push, in cells a step. */
const FASTEST = 0.05;

interface Props {
  live: Live;
  viscosity: number;
  /** Of the stroke, relative to the recorded one. */
  speed: number;
  field: FieldName | "dye";
  /** Pushes that wait for the next step. */
  pushes: Push[];
  onFail: (reason: unknown) => void;
}

export function LiveStage({ live, viscosity, speed, field, pushes, onFail }: Props) {
  const theme = useTheme();
  const [replay, setReplay] = useState<Replay | null>(null);
  const dye = useRef<Dye | null>(null);
  const wanted = useRef({ viscosity, speed });
  wanted.current = { viscosity, speed };
  const steps = Math.max(1, Math.round(live.stage.stroke / FRAMES));
  useEffect(() => {
    let active = true;
    const next = async () => {
      const frame = await live.advance({ steps, ...wanted.current, pushes: pushes.splice(0) });
      if (!active) return;
      if (!frame.positions.every(Number.isFinite)) throw new Error(text.diverged);
      const now = replayOf(live.stage, frame);
      dye.current ??= new Dye(now);
      dye.current.drift(now, steps);
      setReplay(now);
      requestAnimationFrame(() => active && next().catch(onFail));
    };
    next().catch((reason) => active && onFail(reason));
    return () => {
      active = false;
    };
  }, [live]);
  const push = (event: PointerEvent) => {
    if (!replay || (event.buttons === 0 && event.pointerType === "mouse")) return;
    pushes.push(pushOf(event, replay, steps));
  };
  const draw = (canvas: HTMLCanvasElement, size: { width: number; height: number }) => {
    if (!replay) return;
    const shown = field === "dye" ? null : fieldOf(field, [replay], theme);
    const painter = shown && new FluidPainter(replay, shown);
    const tracers = field === "dye" ? dye.current : null;
    drawScene(canvas, size, sceneOf(replay, { painter, follow: true, theme, tracers }), 0);
  };
  return (
    <div class="live-water" onPointerMove={push}>
      <CanvasStage
        size={live.stage.size}
        label={text.liveLabel}
        draw={draw}
        inputs={[replay, field, theme]}
        fits
      />
    </div>
  );
}

/** A push by a pointer; the creature is in the middle. */
function pushOf(event: PointerEvent, replay: Replay, steps: number): Push {
  const box = (event.target as HTMLElement).getBoundingClientRect();
  const [width, height] = replay.header.size;
  const scale = box.width / width;
  const velocity = [event.movementX, -event.movementY].map((moved) => {
    const speed = moved / scale / steps;
    return Math.max(-FASTEST, Math.min(FASTEST, speed));
  });
  return {
    away: [(event.clientX - box.left) / scale - width / 2, height / 2 - (event.clientY - box.top) / scale],
    velocity: velocity as [number, number],
  };
}

/** A replay of one frame. */
function replayOf({ size, edges }: Stage, frame: Frame): Replay {
  const { positions, vorticity, velocity, scales } = frame;
  return {
    header: {
      creature: "",
      frames: 1,
      every: 1,
      steps: 0,
      nodes: positions.length / 2,
      edges,
      joints: [],
      size,
      vorticity: { scale: scales.vorticity },
      velocity: { scale: scales.velocity },
      energy: { scale: 1, frames: 0 },
      fitness: { recorded: null, replayed: null, difference: null },
    },
    positions,
    angles: new Float32Array(0),
    lengths: new Float32Array(0),
    vorticity,
    velocity,
    energy: new Uint8Array(0),
  };
}
