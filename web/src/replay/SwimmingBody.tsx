/** One small moving creature in a square. */

import { useEffect, useRef } from "preact/hooks";
import type { Motion } from "../decode/motion";
import { prepare, useSize, prefersReducedMotion, useTheme } from "../ui/canvas";
import { useClock } from "./clock";
import { traceBody } from "./bodyPath";
import "./replay.css";

/** Duration of a loop. */
const SECONDS = 5;
const INKS = { light: "#12222c", dark: "#fdf8ec" };

export function SwimmingBody({ motion }: { motion: Motion | null }) {
  const box = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const share = useRef(0);
  const { width } = useSize(box);
  const theme = useTheme();
  const draw = () => {
    if (!canvas.current || !motion || width === 0) return;
    const context = prepare(canvas.current, { width, height: width });
    context.lineJoin = context.lineCap = "round";
    context.lineWidth = Math.max(1.25, width / 48);
    context.strokeStyle = INKS[theme];
    traceBody(context, motion, share.current, [0, 0, width]);
    context.stroke();
  };
  useClock(motion !== null && !prefersReducedMotion(), (seconds) => {
    share.current = (share.current + seconds / SECONDS) % 1;
    draw();
  });
  useEffect(draw);
  return (
    <div ref={box} class="swimming" aria-hidden="true">
      <canvas ref={canvas} style={{ width: `${width}px`, height: `${width}px` }} />
    </div>
  );
}
