/** A canvas of fixed proportions, redrawn when its size or its content changes. */

import { useEffect, useRef } from "preact/hooks";
import { type Size, useSize } from "../ui/canvas";
import "./replay.css";

interface Props {
  size: readonly [width: number, height: number];
  label: string;
  draw: (canvas: HTMLCanvasElement, size: Size) => void;
  /** Values that `draw` depends on. */
  inputs: unknown[];
  blank?: boolean;
  /** Keep the stage lower than the window. */
  fits?: boolean;
  onClick?: () => void;
}

export function CanvasStage({ size: [width, height], label, draw, inputs, blank, fits, onClick }: Props) {
  const stage = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const size = useSize(stage);
  useEffect(() => {
    if (size.width > 0) draw(canvas.current!, size);
  }, [size, ...inputs]);
  const maxWidth = fits ? `calc(70vh * ${width / height})` : undefined;
  return (
    <div
      ref={stage}
      class={blank ? "stage blank" : "stage"}
      style={{ aspectRatio: `${width} / ${height}`, maxWidth }}
    >
      <canvas ref={canvas} role="img" aria-label={label} onClick={onClick} />
    </div>
  );
}
