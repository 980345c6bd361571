/** One small moving creature in a square. */

import { useEffect, useRef } from "preact/hooks";
import type { PoseStream } from "../decode/poses";
import { prepare, useOnScreen, useSize, px, useTheme } from "../ui/canvas";
import { BODY_INK } from "./motion";
import { tracePath, traceBody } from "./poses";
import { useSteps } from "./clock";
import "./replay.css";

interface Props {
  stream: PoseStream | null;
  /** A name for screen readers; without one they skip the creature. */
  label?: string;
  /** On dark water, whatever the theme. */
  onWater?: boolean;
  /** Draw the path of the mean position too. */
  path?: boolean;
  /** Called when the first frame is drawn. */
  onFirst?: () => void;
}

export function SwimmingBody({ stream, label, onWater = false, path = false, onFirst }: Props) {
  const box = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const { width } = useSize(box);
  const theme = useTheme();
  const size = { width, height: width };
  const drawn = stream !== null && width > 0;
  const onScreen = useOnScreen(box);
  useSteps(stream !== null && onScreen, (steps) => {
    if (!canvas.current || !drawn) return;
    const context = prepare(canvas.current, size);
    context.lineJoin = context.lineCap = "round";
    context.strokeStyle = BODY_INK[onWater ? "dark" : theme];
    if (path) {
      context.globalAlpha = 0.55;
      context.lineWidth = 1.25;
      tracePath(context, stream, steps, [0, 0, width]);
      context.stroke();
      context.globalAlpha = 1;
    }
    context.lineWidth = Math.max(1.25, width / 48);
    traceBody(context, stream, steps, [0, 0, width]);
    context.stroke();
  });
  useEffect(() => {
    if (drawn) onFirst?.();
  }, [drawn]);
  return (
    <div ref={box} class={`swimming ${onWater ? "on-water" : ""}`} aria-hidden={label === undefined}>
      <canvas
        ref={canvas}
        style={px(size)}
        role={label === undefined ? undefined : "img"}
        aria-label={label}
      />
    </div>
  );
}
