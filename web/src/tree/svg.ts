/** The present view of a tree as SVG: what is drawn on canvases, drawn on one context that writes it. */

import type { Chains } from "./layout";
import { type Overlay, drawOverlay } from "./overlay";
import { type Context, INKS, paint } from "./paint";
import { strokesOf } from "./strokes";

type Scene = Overlay & { chains: Chains; whole: boolean };

export function svgOf(scene: Scene): string {
  const { tree, theme, shades } = scene;
  const context = new SvgContext();
  const strokes = strokesOf({ ...scene, shade: shades.shade, shades: shades.colours.length });
  paint(context, strokes, tree, shades, theme);
  drawOverlay(context, scene);
  const [width, height] = [fixed(scene.size.width), fixed(scene.size.height)];
  const lines = 'stroke-linecap="round" stroke-linejoin="round" font-family="system-ui, sans-serif"';
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" width="${width}" height="${height}" ${lines}>`,
    `<rect width="100%" height="100%" fill="${INKS[theme].ground}"/>`,
    ...context.tags,
    "</svg>",
  ].join("\n");
}

const fixed = (value: number) => String(Math.round(10 * value) / 10);

const ANCHORS: Partial<Record<CanvasTextAlign, string>> = { center: "middle", right: "end" };
const BASELINES: Partial<Record<CanvasTextBaseline, string>> = { middle: "middle", top: "hanging" };
/** The width of a letter, as a share of the size of its font: nothing measures text here. */
const LETTER = 0.55;

/** The part of a canvas context that draws trees, as tags of SVG. */
export class SvgContext implements Context {
  readonly tags: string[] = [];
  fillStyle = "";
  strokeStyle = "";
  lineWidth = 1;
  lineCap: CanvasLineCap = "round";
  lineJoin: CanvasLineJoin = "round";
  globalAlpha = 1;
  font = "";
  textAlign: CanvasTextAlign = "left";
  textBaseline: CanvasTextBaseline = "top";
  private dash: readonly number[] = [];
  /** The data of the present path. */
  d = "";

  beginPath(): void {
    this.d = "";
  }

  moveTo(x: number, y: number): void {
    this.add("M", x, y);
  }

  lineTo(x: number, y: number): void {
    this.add("L", x, y);
  }

  bezierCurveTo(...points: [number, number, number, number, number, number]): void {
    this.add("C", ...points);
  }

  rect(x: number, y: number, width: number, height: number): void {
    this.d += `M${fixed(x)} ${fixed(y)}h${fixed(width)}v${fixed(height)}h${fixed(-width)}z`;
  }

  /** A rectangle, whose corners stay sharp. */
  roundRect(x: number, y: number, width = 0, height = 0): void {
    this.rect(x, y, width, height);
  }

  /** A whole circle. */
  arc(x: number, y: number, radius: number): void {
    const r = fixed(radius);
    this.add("M", x - radius, y);
    this.d += `a${r} ${r} 0 1 1 ${fixed(2 * radius)} 0a${r} ${r} 0 1 1 ${fixed(-2 * radius)} 0z`;
  }

  closePath(): void {
    this.d += "z";
  }

  setLineDash(dash: readonly number[]): void {
    this.dash = dash;
  }

  stroke(): void {
    const dash = this.dash.length > 0 ? ` stroke-dasharray="${this.dash.join(" ")}"` : "";
    this.path(`fill="none" stroke="${this.strokeStyle}" stroke-width="${fixed(this.lineWidth)}"${dash}`);
  }

  fill(): void {
    this.path(`fill="${this.fillStyle}"`);
  }

  fillRect(x: number, y: number, width: number, height: number): void {
    const [left, top] = [fixed(x), fixed(y)];
    const box = `x="${left}" y="${top}" width="${fixed(width)}" height="${fixed(height)}"`;
    this.tags.push(`<rect ${box} fill="${this.fillStyle}" opacity="${this.globalAlpha}"/>`);
  }

  measureText(text: string): { width: number } {
    return { width: LETTER * parseFloat(this.font) * text.length };
  }

  fillText(text: string, x: number, y: number): void {
    const anchor = ANCHORS[this.textAlign] ?? "start";
    const place = `x="${fixed(x)}" y="${fixed(y)}" text-anchor="${anchor}"`;
    const look = `font-size="${parseFloat(this.font)}" dominant-baseline="${BASELINES[this.textBaseline]}"`;
    this.tags.push(`<text ${place} ${look} fill="${this.fillStyle}">${text}</text>`);
  }

  private add(command: string, ...numbers: number[]): void {
    this.d += command + numbers.map(fixed).join(" ");
  }

  private path(look: string): void {
    if (this.d) this.tags.push(`<path d="${this.d}" ${look} opacity="${this.globalAlpha}"/>`);
  }
}
