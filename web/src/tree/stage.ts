/** The canvases of a tree: which part they show, and what is drawn on them, frame by frame. */

import { type Phylogeny, NONE } from "../decode/phylogeny";
import type { PoseStream } from "../decode/poses";
import { STEPS_PER_SECOND } from "../replay/clock";
import { type Size, type Theme, prefersReducedMotion, prepare } from "../ui/canvas";
import { type Landmark, landmarksOf, ranked } from "./landmarks";
import { nearest } from "./nearest";
import { type Overlay, drawOverlay } from "./overlay";
import type { Arranged, Painter, Picture } from "./painter";
import { type ColourBy, type Shades, shadesOf } from "./shades";
import {
  type Extent,
  type Place,
  type Scales,
  type View,
  clamped,
  extentOf,
  moved,
  placeOf,
  scalesOf,
  whole,
  zoomFor,
  zoomOf,
  zoomed,
} from "./view";

/** The choices of the page. */
export interface Shown {
  /** The latest time that is drawn. */
  at: number;
  /** True if creatures within lines of single descendants are drawn too. */
  whole: boolean;
  by: ColourBy;
  theme: Theme;
  focus: number;
  poses: ReadonlyMap<string, PoseStream>;
}

/** A picture is larger than the window by this factor, so that the tree can be dragged. */
const SPARE = 1.6;
/** Bodies and pictures follow a view that has been still for this long. */
const SETTLED_MS = 90;
/** The moment of bodies that do not move. */
const STILL_STEP = 30;
/** Height of a row, in pixels, where the page begins with a creature. */
const FOUND_ROW = 26;
/** Distance from the border within which a creature counts as outside, in pixels. */
const EDGE = 40;
/** A tab that was hidden continues where it was. */
const LONGEST_MS = 100;
/** Opacity of the picture below a line of descent. */
const [DIMMED, FULL] = ["0.42", "1"];
const PAINTED = ["at", "whole", "by", "theme"] as const;

export interface Canvases {
  picture: HTMLCanvasElement;
  overlay: HTMLCanvasElement;
}

type OnView = (zoom: number, landmarks: Landmark[]) => void;

/** One tree in one window; `onView` is called when another part of it has come to rest. */
export class Stage {
  private tree: Phylogeny | null = null;
  private found!: Arranged;
  private painter: Painter | null = null;
  private extent: Extent = { firstTime: 0, lastTime: 1, rows: 1, gap: 1 };
  private size: Size = { width: 0, height: 0 };
  private view: View = { zoom: 0, time: 0, row: 0 };
  private shown!: Shown;
  private shades!: Shades;
  private ranking: Int32Array = new Int32Array(0);
  private begins: number[] = [];
  private picture: Picture | null = null;
  private landmarks: Landmark[] = [];
  private steps = STILL_STEP;
  /** The time of the last frame; 0 while nothing moves. */
  private last = 0;
  private frame = 0;
  private timer = 0;

  constructor(
    private readonly canvases: Canvases,
    private readonly onView: OnView,
  ) {}

  private get ready(): boolean {
    return this.tree !== null && this.size.width > 0;
  }

  private get scales(): Scales {
    return scalesOf(this.extent, this.size, this.view.zoom);
  }

  /** All that is drawn now. */
  get scene(): Overlay & Arranged & Shown {
    const { shown, found, view, scales, size, shades, landmarks, steps, begins } = this;
    return { ...shown, ...found, tree: this.tree!, view, scales, size, shades, landmarks, steps, begins };
  }

  /** Show a tree; the view stays if one was shown before. */
  load({ tree, ...found }: Arranged & { tree: Phylogeny }, painter: Painter, shown: Shown): void {
    const first = this.tree === null;
    [this.tree, this.found, this.painter, this.shown] = [tree, found, painter, shown];
    this.landmarks = [];
    this.extent = extentOf(tree, found.layout);
    this.begins = beginsOf(tree);
    this.rank();
    if (first) this.view = whole(this.extent);
    if (first && this.shown.focus !== NONE && this.ready) this.find(this.shown.focus);
    else this.change(clamped(this.view, this.extent, this.size));
  }

  show(next: Shown): void {
    const before = this.shown as Shown | undefined;
    this.shown = next;
    if (!this.ready) return;
    if (before?.by !== next.by || before.theme !== next.theme) this.rank();
    if (before && PAINTED.every((key) => before[key] === next[key])) this.invalidate();
    else this.settle();
  }

  resize(size: Size): void {
    this.size = size;
    if (this.ready) this.change(clamped(this.view, this.extent, size));
  }

  painted(picture: Picture, bitmap: ImageBitmap): void {
    this.picture = picture;
    const canvas = this.canvases.picture;
    [canvas.width, canvas.height] = [bitmap.width, bitmap.height];
    canvas.style.width = `${picture.size.width}px`;
    canvas.style.height = `${picture.size.height}px`;
    canvas.getContext("bitmaprenderer")!.transferFromImageBitmap(bitmap);
    performance.clearMarks("tree");
    performance.mark("tree");
    this.invalidate();
  }

  pan(by: Place): void {
    if (this.ready) this.change(moved(this.view, by, this.extent, this.size));
  }

  /** Enlarge by a factor, given as its natural logarithm, around a place. */
  zoom(log: number, at?: Place): void {
    const { extent, size, view } = this;
    const place = at ?? ([size.width / 2, size.height / 2] as const);
    if (this.ready) this.change(zoomed(view, zoomFor(log, extent, size), place, extent, size));
  }

  all(): void {
    if (this.ready) this.change(clamped(whole(this.extent), this.extent, this.size));
  }

  creatureAt(place: Place): number {
    if (!this.ready) return NONE;
    return nearest(this.tree!, this.found.layout, place, this.view, this.scales, this.size, this.shown.at);
  }

  /** Bring a creature into the middle, large enough to be told from others. */
  find(creature: number): void {
    const zoom = Math.max(this.view.zoom, zoomOf(FOUND_ROW, this.extent, this.size));
    this.change(clamped({ zoom, ...this.pointOf(creature) }, this.extent, this.size));
  }

  /** Bring a creature into the window, if it is outside. */
  reveal(creature: number): void {
    const [x, y] = placeOf(this.pointOf(creature), this.scales, this.view, this.size);
    const { width, height } = this.size;
    if (x > EDGE && y > EDGE && x < width - EDGE && y < height - EDGE) return;
    this.change(clamped({ ...this.view, ...this.pointOf(creature) }, this.extent, this.size));
  }

  /** True if a creature is in the left half of the window. */
  isLeft(creature: number): boolean {
    if (!this.ready) return false;
    return placeOf(this.pointOf(creature), this.scales, this.view, this.size)[0] < this.size.width / 2;
  }

  stop(): void {
    cancelAnimationFrame(this.frame);
    clearTimeout(this.timer);
  }

  private pointOf(creature: number) {
    return { time: this.tree!.time[creature]!, row: this.found.layout.row[creature]! };
  }

  private change(view: View): void {
    this.view = view;
    this.invalidate();
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.settle(), SETTLED_MS);
    if (this.picture && !covers(this.picture, view, this.scales, this.size)) this.order();
  }

  /** Order a picture of the present view. */
  private order(): void {
    if (!this.ready) return;
    const { at, whole, by, theme } = this.shown;
    const [width, height] = [this.size.width, this.size.height].map((side) => Math.ceil(side * SPARE));
    const size = { width: width!, height: height! };
    const density = Math.min(2, window.devicePixelRatio || 1);
    this.painter?.paint({ view: this.view, scales: this.scales, size, density, at, whole, by, theme });
  }

  private settle(): void {
    if (!this.ready) return;
    const { tree, found, view, scales, size, shown, ranking } = this;
    const first = shown.focus === NONE ? [] : [shown.focus];
    this.landmarks = landmarksOf(ranking, tree!, found.layout, view, scales, size, shown.at, first);
    this.onView(view.zoom, this.landmarks);
    this.order();
    this.invalidate();
  }

  private invalidate(): void {
    if (this.frame === 0) this.frame = requestAnimationFrame((now) => this.draw(now));
  }

  private draw(now: number): void {
    this.frame = 0;
    if (!this.ready) return;
    performance.clearMeasures("tree-draw");
    const start = performance.now();
    const alive = this.landmarks.length > 0 && !prefersReducedMotion();
    const seconds = Math.min(LONGEST_MS, now - this.last) / 1000;
    if (alive && this.last > 0) this.steps += seconds * STEPS_PER_SECOND;
    this.last = alive ? now : 0;
    this.movePicture();
    drawOverlay(prepare(this.canvases.overlay, this.size), this.scene);
    performance.measure("tree-draw", { start });
    if (alive) this.invalidate();
  }

  private movePicture(): void {
    const { picture, scales } = this;
    if (!picture) return;
    const [wide, high] = [scales.x / picture.scales.x, scales.y / picture.scales.y];
    const [x, y] = placeOf(picture.view, scales, this.view, this.size);
    const [left, top] = [x - (picture.size.width / 2) * wide, y - (picture.size.height / 2) * high];
    const { style } = this.canvases.picture;
    style.transform = `matrix(${wide}, 0, 0, ${high}, ${left}, ${top})`;
    style.opacity = this.shown.focus === NONE ? FULL : DIMMED;
  }

  private rank(): void {
    this.shades = shadesOf(this.tree!, this.shown.by, this.shown.theme);
    const { fitness } = this.tree!;
    const [low, high] = this.shades.range;
    this.ranking = ranked(this.tree!, this.found.layout, (i) => (fitness[i]! - low) / (high - low) || 0);
  }
}

/** True if a picture has all of a window at its own scales. */
function covers(picture: Picture, view: View, scales: Scales, size: Size): boolean {
  if (picture.scales.x !== scales.x || picture.scales.y !== scales.y) return false;
  const [x, y] = placeOf(picture.view, scales, view, size);
  const [spareX, spareY] = [(picture.size.width - size.width) / 2, (picture.size.height - size.height) / 2];
  // A new picture is ordered before the old one ends.
  return Math.abs(x - size.width / 2) < 0.5 * spareX && Math.abs(y - size.height / 2) < 0.5 * spareY;
}

/** The time at which each run began. */
function beginsOf({ run, time, generation, runs, count }: Phylogeny): number[] {
  const begins = runs.map(() => Infinity);
  for (let i = 0; i < count; i++) {
    if (run[i] !== NONE) begins[run[i]!] = Math.min(begins[run[i]!]!, time[i]! - generation[i]!);
  }
  return begins;
}
