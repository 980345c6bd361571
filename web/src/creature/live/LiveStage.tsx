/** The live water around a creature, which begins with the inputs; pointers push the water and pull the body. */

import { useEffect, useRef, useState } from "preact/hooks";
import { type Replay, motionOnly } from "../../decode/replay";
import { CanvasStage } from "../../replay/CanvasStage";
import { type FieldName, FluidPainter, fieldOf } from "../../replay/fields";
import { BODY_INK, wrap } from "../../replay/motion";
import { drawScene, sceneOf } from "../../replay/scene";
import { Live } from "../../simulate/simulator";
import type { Frame, Stage } from "../../simulate/swim";
import { type Size, type Theme, useTheme } from "../../ui/canvas";
import { text } from "./text";
import { type View, type Wishes, awayOf, nodeAt, placesOf, pushOf } from "./touch";
import { type Particles, initialPositions, velocityAt } from "../../replay/tracers";
import { decodeEvaluation } from "../../decode/evaluation";

/** Frames in a stroke. */
const FRAMES = 90;

interface Props {
  live: Live;
  viscosity: number;
  /** Speed of the stroke, relative to the recorded one. */
  speed: number;
  field: FieldName | "dye";
  wishes: Wishes;
  onRefuse: (reason: string) => void;
  onFail: (reason: unknown) => void;
}

export function LiveStage({ live, viscosity, speed, field, wishes, onRefuse, onFail }: Props) {
  const theme = useTheme();
  const [view, setView] = useState<View | null>(null);
  const dye = useRef<Dye | null>(null);
  const wanted = useRef({ viscosity, speed });
  wanted.current = { viscosity, speed };
  const steps = Math.max(1, Math.round(live.stage.stroke / FRAMES));
  useEffect(() => {
    let active = true;
    const next = async () => {
      const { pull } = wishes;
      const [pushes, joining] = [wishes.pushes.splice(0), wishes.joining.splice(0)];
      const { frame, refused } = await live.advance({ steps, ...wanted.current, pushes, pull, joining });
      if (!active) return;
      if (refused) onRefuse(refused);
      if (!frame.positions.every(Number.isFinite)) throw new Error(text.diverged);
      const replay = replayOf(live.stage, frame);
      dye.current ??= new Dye(replay);
      dye.current.drift(replay, steps);
      setView({ replay, leader: frame.leader });
      requestAnimationFrame(() => active && next().catch(onFail));
    };
    next().catch((reason) => active && onFail(reason));
    return () => {
      active = false;
    };
  }, [live]);
  const draw = (canvas: HTMLCanvasElement, size: Size) => {
    if (!view) return;
    const { replay, leader } = view;
    const shown = field === "dye" ? null : fieldOf(field, [replay], theme);
    const painter = shown && new FluidPainter(replay, shown);
    const tracers = field === "dye" ? dye.current : null;
    drawScene(canvas, size, sceneOf(replay, { painter, follow: true, theme, tracers, leader }), 0);
    drawPull(canvas, size, view, wishes, theme);
  };
  return (
    <div class="live-water" {...touching(view, wishes, steps)}>
      <CanvasStage size={live.stage.size} label={text.label} draw={draw} inputs={[view, field, theme]} fits />
    </div>
  );
}

/** A pressed pointer pulls the body if it begins on it, and else pushes the water. */
function touching(view: View | null, wishes: Wishes, steps: number) {
  const boxOf = ({ target }: PointerEvent) => (target as HTMLElement).getBoundingClientRect();
  const release = () => {
    wishes.pull = null;
  };
  return {
    onPointerDown: (event: PointerEvent) => {
      if (!view) return;
      const node = nodeAt(event, boxOf(event), view);
      if (node === null) return;
      (event.target as HTMLElement).setPointerCapture(event.pointerId);
      wishes.pull = { node, away: awayOf(event, boxOf(event), view) };
    },
    onPointerMove: (event: PointerEvent) => {
      if (!view || (event.buttons === 0 && event.pointerType === "mouse")) return;
      if (wishes.pull) wishes.pull = { ...wishes.pull, away: awayOf(event, boxOf(event), view) };
      else wishes.pushes.push(pushOf(event, boxOf(event), view, steps));
    },
    onPointerUp: release,
    onPointerCancel: release,
  };
}

/** A line from the pulled node to the pointer. */
function drawPull(canvas: HTMLCanvasElement, size: Size, view: View, { pull }: Wishes, theme: Theme): void {
  const context = canvas.getContext("2d");
  const node = pull && placesOf(view)[pull.node];
  if (!context || !node) return;
  const [width, height] = view.replay.header.size;
  const scale = size.width / width;
  const ends = [node, pull.away].map(
    ([x, y]) => [(x + width / 2) * scale, (height / 2 - y) * scale] as const,
  );
  context.strokeStyle = context.fillStyle = BODY_INK[theme];
  context.lineWidth = 1.5;
  context.setLineDash([4, 4]);
  context.beginPath();
  context.moveTo(...ends[0]!);
  context.lineTo(...ends[1]!);
  context.stroke();
  context.setLineDash([]);
  context.beginPath();
  context.arc(...ends[1]!, 4, 0, 2 * Math.PI);
  context.fill();
}

/** A replay of one frame. */
function replayOf({ size }: Stage, { positions, edges, vorticity, velocity, scales }: Frame): Replay {
  const moments = { frames: 1, every: 1, steps: 0 };
  const fields = { vorticity: { scale: scales.vorticity }, velocity: { scale: scales.velocity } };
  const header = { creature: "", ...moments, nodes: positions.length / 2, edges, size, ...fields };
  return motionOnly(header, { positions, vorticity, velocity });
}

/** Cells per particle. */
const CELLS = 1.5;

/** Particles that drift in live water. */
class Dye implements Particles {
  private readonly places: Float32Array;

  /** `replay` is the present state, as one frame. */
  constructor(public replay: Replay) {
    this.places = initialPositions(...replay.header.size, CELLS);
  }

  at(): Float32Array {
    return this.places;
  }

  /** Drift for some steps with the water of the next state. */
  drift(replay: Replay, steps: number): void {
    this.replay = replay;
    const [width, height] = replay.header.size;
    for (let i = 0; i < this.places.length; i += 2) {
      const [u, v] = velocityAt(replay, 0, this.places[i]!, this.places[i + 1]!);
      // Within the box: a float far from it would swallow the steps.
      this.places[i] = wrap(this.places[i]! + steps * u, width);
      this.places[i + 1] = wrap(this.places[i + 1]! + steps * v, height);
    }
  }
}

/** Null until the creature is evaluated; it ends with the component, or with other inputs. */
export function useLive(inputs: ArrayBuffer | null, onFail: (reason: unknown) => void): Live | null {
  const [live, setLive] = useState<Live | null>(null);
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
      .catch((reason) => active && onFail(reason));
    return () => {
      active = false;
      begun?.end();
      setLive(null);
    };
  }, [inputs]);
  return live;
}

async function begin(inputs: ArrayBuffer): Promise<Live> {
  const { uncovered } = decodeEvaluation(inputs);
  if (uncovered !== null) throw new Error(text.notCovered(uncovered));
  return Live.begin(inputs);
}
