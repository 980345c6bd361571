/** One small moving creature in a square. */

import { useRef } from "preact/hooks";
import type { Motion } from "../decode/replay";
import { prepare, useSize, px, useTheme } from "../ui/canvas";
import { BODY_INK, traceBody } from "./motion";
import { useLoop } from "./clock";
import "./replay.css";

export function SwimmingBody({ motion }: { motion: Motion | null }) {
  const box = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const { width } = useSize(box);
  const theme = useTheme();
  const size = { width, height: width };
  useLoop(motion !== null, (share) => {
    if (!canvas.current || !motion || width === 0) return;
    const context = prepare(canvas.current, size);
    context.lineJoin = context.lineCap = "round";
    context.lineWidth = Math.max(1.25, width / 48);
    context.strokeStyle = BODY_INK[theme];
    traceBody(context, motion, share, [0, 0, width]);
    context.stroke();
  });
  return (
    <div ref={box} class="swimming" aria-hidden="true">
      <canvas ref={canvas} style={px(size)} />
    </div>
  );
}
