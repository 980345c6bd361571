/** The present view of a tree as SVG. */

import { NONE, isElite, nameAt } from "../decode/phylogeny";
import { BODY_INK } from "../replay/motion";
import { traceBody } from "../replay/poses";
import { shortId } from "../ui/format";
import { lineOf, otherParents } from "./nearest";
import type { Overlay } from "./overlay";
import { INKS, traceDot, traceEdge } from "./paint";
import type { Chains } from "./layout";
import { radiusOf, shapeOf } from "./shades";
import { type Strokes, WIDTHS, lineIndex, strokesOf } from "./strokes";
import { placeOf } from "./view";

type Scene = Overlay & { chains: Chains; whole: boolean };

export function svgOf(scene: Scene): string {
  const { tree, size, theme, shades } = scene;
  const strokes = strokesOf({ ...scene, shade: shades.shade, shades: shades.colours.length });
  const { ink, ground, quiet } = INKS[theme];
  const line = scene.focus === NONE ? [] : lineOf(scene.layout, scene.focus);
  const others = otherParents(tree, scene.layout, line);
  const steps = line.slice(1).map((parent, k): [number, number] => [line[k]!, parent]);
  const counts = strokes.counts.flatMap((_, k, all) =>
    k % 3 ? [] : [`<text x="${fixed(all[k]!)}" y="${fixed(all[k + 1]! - 4)}">+${all[k + 2]!}</text>`],
  );
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${fixed(size.width)} ${fixed(size.height)}" width="${fixed(size.width)}" height="${fixed(size.height)}">`,
    `<rect width="100%" height="100%" fill="${ground}"/>`,
    `<g fill="none" stroke-linecap="round" stroke-linejoin="round">`,
    ...edges(strokes, scene),
    pathTag(links(others, scene), `stroke="${ink}" stroke-opacity="0.4" stroke-dasharray="3 4"`),
    pathTag(links(steps, scene), `stroke="${ink}" stroke-width="2.4"`),
    ...dots(strokes, scene),
    ...bodies(scene),
    "</g>",
    `<g font-family="system-ui, sans-serif" font-size="11" fill="${quiet}" text-anchor="middle">`,
    ...counts,
    "</g>",
    "</svg>",
  ].join("\n");
}

const fixed = (value: number) => String(Math.round(10 * value) / 10);

const pathTag = (d: string, attributes: string) => (d ? `<path d="${d}" ${attributes}/>` : "");

function edges({ lines }: Strokes, { shades: { colours } }: Scene): string[] {
  return WIDTHS.flatMap((width, k) =>
    colours.map((colour, shade) => {
      const line = lines[lineIndex(k, shade, colours.length)]!;
      const path = new PathWriter();
      for (let i = 0; i < line.length; i += 4) {
        traceEdge(path, line[i]!, line[i + 1]!, line[i + 2]!, line[i + 3]!);
      }
      return pathTag(path.d, `stroke="${colour}" stroke-width="${width}"`);
    }),
  ).filter(Boolean);
}

function links(pairs: readonly [number, number][], scene: Scene): string {
  const path = new PathWriter();
  const place = (i: number) =>
    placeOf({ time: scene.tree.time[i]!, row: scene.layout.row[i]! }, scene.scales, scene.view, scene.size);
  for (const [child, parent] of pairs) traceEdge(path, ...place(parent), ...place(child));
  return path.d;
}

function dots({ dots }: Strokes, { tree, shades, theme }: Scene): string[] {
  const tags: string[] = [];
  for (let k = 0; k < dots.length; k += 3) {
    const i = dots[k + 2]!;
    const path = new PathWriter();
    const shape = shades.by === "operator" ? shapeOf(tree, tree.operator[i]!) : "circle";
    traceDot(path, shape, dots[k]!, dots[k + 1]!, radiusOf(shades, i));
    const colour = shades.colours[shades.shade[i]!]!;
    const fill = isElite(tree, i) ? colour : INKS[theme].ground;
    const title = `<title>${shortId(nameAt(tree, i))}</title>`;
    tags.push(`<path d="${path.d}" fill="${fill}" stroke="${colour}" stroke-width="1.4">${title}</path>`);
  }
  return tags;
}

function bodies({
  tree,
  landmarks,
  layout,
  poses,
  shades,
  theme,
  steps,
  view,
  scales,
  size,
}: Scene): string[] {
  return landmarks.flatMap(({ creature, side }) => {
    const stream = poses.get(nameAt(tree, creature));
    if (!stream) return [];
    const [x, y] = placeOf({ time: tree.time[creature]!, row: layout.row[creature]! }, scales, view, size);
    const path = new PathWriter();
    const inner = side * 0.86;
    traceBody(path, stream, steps, [x - inner / 2, y - inner / 2, inner]);
    const colour = shades.colours[shades.shade[creature]!]!;
    return [
      `<circle cx="${fixed(x)}" cy="${fixed(y)}" r="${fixed(side / 2)}" fill="${INKS[theme].ground}" fill-opacity="0.95" stroke="${colour}" stroke-width="1.5"/>`,
      pathTag(path.d, `stroke="${BODY_INK[theme]}" stroke-width="${fixed(Math.max(1.3, side / 34))}"`),
    ];
  });
}

/** Writes what is traced on it as the data of an SVG path. */
export class PathWriter {
  private parts: string[] = [];

  get d(): string {
    return this.parts.join("");
  }

  beginPath(): void {
    this.parts = [];
  }

  moveTo(x: number, y: number): void {
    this.write("M", x, y);
  }

  lineTo(x: number, y: number): void {
    this.write("L", x, y);
  }

  bezierCurveTo(...points: [number, number, number, number, number, number]): void {
    this.write("C", ...points);
  }

  rect(x: number, y: number, width: number, height: number): void {
    this.parts.push(`M${fixed(x)} ${fixed(y)}h${fixed(width)}v${fixed(height)}h${fixed(-width)}z`);
  }

  /** A whole circle. */
  arc(x: number, y: number, radius: number): void {
    const r = fixed(radius);
    this.write("M", x - radius, y);
    this.parts.push(`a${r} ${r} 0 1 1 ${fixed(2 * radius)} 0a${r} ${r} 0 1 1 ${fixed(-2 * radius)} 0z`);
  }

  closePath(): void {
    this.parts.push("z");
  }

  private write(command: string, ...numbers: number[]): void {
    this.parts.push(command + numbers.map(fixed).join(" "));
  }
}
