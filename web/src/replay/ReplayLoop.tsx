/** A small replay that plays in a loop. */

import { useMemo, useState } from "preact/hooks";
import type { Replay } from "../decode/replay";
import { type Size, prefersReducedMotion, useTheme } from "../ui/canvas";
import { CanvasStage } from "./CanvasStage";
import { STEPS_PER_SECOND, useClock } from "./clock";
import { fieldOf } from "./fields";
import { FluidPainter } from "./fluid";
import { drawScene, sceneOf } from "./scene";

interface Props {
  replay: Replay;
  name: string;
}

export function ReplayLoop({ replay, name }: Props) {
  const theme = useTheme();
  const { frames, every } = replay.header;
  const [time, setTime] = useState(0);
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
  };
  return <CanvasStage size={replay.header.size} label={name} draw={draw} inputs={[scene, time]} />;
}
