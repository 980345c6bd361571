/** Draw the strokes of a tree on a canvas. */

import { type Phylogeny, isElite } from "../decode/phylogeny";
import type { Theme } from "../ui/canvas";
import { type Shades, type Shape, radiusOf, shapeOf } from "./shades";
import { type Strokes, WIDTHS, bendOf, lineIndex } from "./strokes";

/** A surface that trees are drawn on: a canvas, one of a worker, or SVG. */
export type Context = Pick<
  CanvasRenderingContext2D,
  | ("beginPath" | "moveTo" | "lineTo" | "bezierCurveTo" | "arc" | "rect" | "roundRect" | "closePath")
  | ("fill" | "stroke" | "fillRect" | "fillText" | "setLineDash" | "fillStyle" | "strokeStyle")
  | ("lineWidth" | "lineCap" | "lineJoin" | "globalAlpha" | "font" | "textAlign" | "textBaseline")
> & { measureText: (text: string) => { width: number } };

export const INKS = {
  light: { ink: "#14222b", quiet: "#5a6b76", ground: "#eef5f6" },
  dark: { ink: "#e3ebef", quiet: "#93a5b0", ground: "#08171d" },
};

export function paint(
  context: Context,
  strokes: Strokes,
  tree: Phylogeny,
  shades: Shades,
  theme: Theme,
): void {
  const { colours } = shades;
  context.lineCap = "round";
  context.lineJoin = "round";
  WIDTHS.forEach((width, k) => {
    colours.forEach((colour, shade) => {
      const line = strokes.lines[lineIndex(k, shade, colours.length)]!;
      if (line.length === 0) return;
      context.strokeStyle = colour;
      context.lineWidth = width;
      context.beginPath();
      for (let i = 0; i < line.length; i += 4) {
        traceEdge(context, line[i]!, line[i + 1]!, line[i + 2]!, line[i + 3]!);
      }
      context.stroke();
    });
  });
  paintDots(context, strokes, tree, shades, theme);
  paintCounts(context, strokes, theme);
}

export function traceEdge(
  path: Pick<CanvasPath, "moveTo" | "lineTo" | "bezierCurveTo">,
  x: number,
  y: number,
  toX: number,
  toY: number,
): void {
  path.moveTo(x, y);
  if (Math.abs(toY - y) > 0.5) {
    const { straightFrom, middle } = bendOf(x, y, toX, toY);
    path.bezierCurveTo(middle, y, middle, toY, straightFrom, toY);
  }
  path.lineTo(toX, toY);
}

function paintDots(context: Context, { dots }: Strokes, tree: Phylogeny, shades: Shades, theme: Theme): void {
  context.lineWidth = 1.4;
  for (let k = 0; k < dots.length; k += 3) {
    const [x, y, i] = [dots[k]!, dots[k + 1]!, dots[k + 2]!];
    const colour = shades.colours[shades.shade[i]!]!;
    context.beginPath();
    traceDot(
      context,
      shades.by === "operator" ? shapeOf(tree, tree.operator[i]!) : "circle",
      x,
      y,
      radiusOf(shades, i),
    );
    // An elite of today is filled, one that was lost is hollow.
    context.fillStyle = isElite(tree, i) ? colour : INKS[theme].ground;
    context.strokeStyle = colour;
    context.fill();
    context.stroke();
  }
}

type DotPath = Pick<CanvasPath, "moveTo" | "lineTo" | "arc" | "rect" | "closePath">;

function traceDot(context: DotPath, shape: Shape, x: number, y: number, radius: number): void {
  const r = radius * 1.15;
  if (shape === "circle") context.arc(x, y, radius, 0, 2 * Math.PI);
  else if (shape === "square") context.rect(x - 0.9 * r, y - 0.9 * r, 1.8 * r, 1.8 * r);
  else {
    const top = shape === "diamond" ? 1.25 : 1.1;
    context.moveTo(x, y - top * r);
    context.lineTo(x + 1.2 * r, shape === "diamond" ? y : y + 0.9 * r);
    if (shape === "diamond") context.lineTo(x, y + top * r);
    context.lineTo(x - 1.2 * r, shape === "diamond" ? y : y + 0.9 * r);
    context.closePath();
  }
}

function paintCounts(context: Context, { counts }: Strokes, theme: Theme): void {
  const { quiet, ground } = INKS[theme];
  context.font = "11px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  for (let k = 0; k < counts.length; k += 3) {
    const label = `+${counts[k + 2]!}`;
    const width = context.measureText(label).width + 8;
    context.fillStyle = ground;
    context.fillRect(counts[k]! - width / 2, counts[k + 1]! - 7, width, 14);
    context.fillStyle = quiet;
    context.fillText(label, counts[k]!, counts[k + 1]!);
  }
}
