/** A small replay that plays by itself, again and again. */

import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Replay } from "../decode/replay";
import { useSize } from "../ui/canvas";
import { prefersStillness, useTheme } from "../ui/theme";
import { useClock } from "./clock";
import { fieldOf } from "./fields";
import { FluidPainter } from "./fluid";
import { chainsOf } from "./motion";
import { drawScene, wayOf } from "./scene";
import "./replay.css";

/** Steps of the simulation in a second. */
const PACE = 80;

interface Props {
  replay: Replay;
  name: string;
  /** Once its first frame is drawn. */
  onFirst?: () => void;
}

export function ReplayLoop({ replay, name, onFirst }: Props) {
  const stage = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const size = useSize(stage);
  const theme = useTheme();
  const { frames, every } = replay.header;
  const [width, height] = replay.header.size;
  const [time, setTime] = useState(0);
  const drawn = useRef(false);
  const still = prefersStillness();
  useClock(!still, (seconds) => {
    setTime((now) => (now + (seconds * PACE) / every) % Math.max(1, frames - 1));
  });
  const scene = useMemo(() => {
    const painter = new FluidPainter(replay, fieldOf("vorticity", [replay], theme)!);
    const chains = chainsOf(replay.header.edges);
    return { replay, painter, chains, way: wayOf(replay), follow: true, theme };
  }, [replay, theme]);
  useEffect(() => {
    if (size.width === 0) return;
    drawScene(canvas.current!, size, scene, still ? frames - 1 : time);
    if (!drawn.current) onFirst?.();
    drawn.current = true;
  }, [size, scene, time]);
  return (
    <div ref={stage} class="stage" style={{ aspectRatio: `${width} / ${height}` }}>
      <canvas ref={canvas} role="img" aria-label={name} />
    </div>
  );
}
