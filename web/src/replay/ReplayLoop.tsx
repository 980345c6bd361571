/** A small replay that plays in a loop. */

import { useMemo, useRef, useState } from "preact/hooks";
import type { Replay } from "../decode/replay";
import { type Size, prefersReducedMotion, useTheme } from "../ui/canvas";
import { CanvasStage } from "./CanvasStage";
import { useClock } from "./clock";
import { fieldOf } from "./fields";
import { FluidPainter } from "./fluid";
import { drawScene, sceneOf } from "./scene";

/** Simulated steps per second. */
const STEPS_PER_SECOND = 80;

interface Props {
  replay: Replay;
  name: string;
  /** Called when the first frame is drawn. */
  onFirst?: () => void;
}

export function ReplayLoop({ replay, name, onFirst }: Props) {
  const theme = useTheme();
  const { frames, every } = replay.header;
  const [time, setTime] = useState(0);
  const drawn = useRef(false);
  const still = prefersReducedMotion();
  useClock(!still, (seconds) => {
    setTime((now) => (now + (seconds * STEPS_PER_SECOND) / every) % Math.max(1, frames - 1));
  });
  const scene = useMemo(() => {
    const painter = new FluidPainter(replay, fieldOf("vorticity", [replay], theme)!);
    return sceneOf(replay, { painter, follow: true, theme });
  }, [replay, theme]);
  const draw = (canvas: HTMLCanvasElement, size: Size) => {
    drawScene(canvas, size, scene, still ? frames - 1 : time);
    if (!drawn.current) onFirst?.();
    drawn.current = true;
  };
  return <CanvasStage size={replay.header.size} label={name} draw={draw} inputs={[scene, time]} />;
}
