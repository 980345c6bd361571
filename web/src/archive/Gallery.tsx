/** The archive as a gallery of moving creatures, placed by their descriptors. */

import type { ComponentChildren, RefObject } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { useSteps } from "../replay/clock";
import { readArchiveBatch, usePoses } from "../store/poses";
import { setQuery } from "../store/router";
import { useKnownChoices } from "../store/choices";
import { type Size, type Theme, useOnScreen, useSize, px, useTheme, prepare } from "../ui/canvas";
import { AxisLabels, ColourLegend } from "./labels";
import type { MapAxis } from "./axes";
import { type ArchiveViewProps, tileUnder, useBinFocus } from "./binFocus";
import { EliteMeasures } from "./EliteMeasures";
import { type Shape, cornerOf, visibleBins } from "./layout";
import { binsOf, cellsIn, isAdditive, toggle } from "./selection";
import { text } from "./text";
import type { PoseStream } from "../decode/poses";
import { css, sequential } from "../ui/colours";
import { type Colouring, colourPosition } from "./colouring";
import { markDistrusted, FADED } from "./mapCanvas";
import type { Tiles } from "./projection";
import { BODY_INK } from "../replay/motion";
import { traceBody } from "../replay/poses";

const [SMALLEST, LARGEST] = [36, 180];
/** Smaller tiles are hard to read: the gallery scrolls instead. */
const MIN_READABLE = 52;

interface GalleryProps extends ArchiveViewProps {
  /** The run whose cells these are; null if they are others. */
  run: string | null;
  /** The generation shown; null for the newest. */
  at: number | null;
  query: URLSearchParams;
}

export function Gallery({ query, ...props }: GalleryProps) {
  const { axes } = props;
  const shape: Shape = [axes[0].bins, axes[1].bins];
  const port = useRef<HTMLDivElement>(null);
  const size = useSize(port);
  const [scroll, setScroll] = useState<Offset>([0, 0]);
  const [requested, setSide] = useState(() => Number(query.get("tile")) || null);
  const fitting = Math.max(MIN_READABLE, Math.floor(size.width / shape[0]));
  const side = Math.min(LARGEST, Math.max(SMALLEST, requested ?? fitting));
  const total: Size = { width: side * shape[0], height: side * shape[1] };
  const view = { width: Math.min(size.width, total.width), height: Math.min(size.height, total.height) };
  const focus = useBinFocus(props, (bin) => scrollToTile(port.current!, cornerOf(bin, shape, side), side));
  return (
    <div class="gallery" data-gallery>
      <TileSize side={side} onSide={setSide} />
      <div class="gallery-frame">
        <AxisRail axis={axes[1]} side="y" offset={-scroll[1]} length={total.height} view={view.height} />
        <Viewport {...props} {...{ port, focus, total }} onScroll={setScroll}>
          <VisibleTiles {...props} {...{ shape, side, scroll }} size={view} marked={focus.focused} />
        </Viewport>
        <AxisRail axis={axes[0]} side="x" offset={-scroll[0]} length={total.width} view={view.width} />
      </div>
      <ColourLegend colouring={props.colouring} />
      <EliteMeasures {...props} tile={focus.tile} hint={text.galleryHint} />
    </div>
  );
}

type Offset = readonly [left: number, top: number];

function TileSize({ side, onSide }: { side: number; onSide: (side: number) => void }) {
  return (
    <label class="compact gallery-size">
      {text.tileSize}
      <input
        type="range"
        min={SMALLEST}
        max={LARGEST}
        value={side}
        onInput={(event) => onSide(event.currentTarget.valueAsNumber)}
        onChange={(event) => setQuery({ tile: event.currentTarget.value })}
      />
    </label>
  );
}

interface ViewportProps extends ArchiveViewProps {
  port: RefObject<HTMLDivElement | null>;
  focus: ReturnType<typeof useBinFocus>;
  /** The size of all tiles together. */
  total: Size;
  onScroll: (scroll: Offset) => void;
  children: ComponentChildren;
}

/** The scrolling window, with pointer and keys. */
function Viewport({ port, focus, total, onScroll, children, ...props }: ViewportProps) {
  const { projection, selected, onSelect } = props;
  const element = useRef<HTMLDivElement>(null);
  const binUnder = (event: MouseEvent) => tileUnder(event, element.current!, projection);
  return (
    <div
      ref={port}
      class={`gallery-port ${focus.hovered === null ? "" : "over"}`}
      tabIndex={0}
      role="application"
      aria-label={text.galleryLabel(onSelect !== null)}
      aria-describedby="elite-measures"
      onScroll={({ currentTarget: { scrollLeft, scrollTop } }) => onScroll([scrollLeft, scrollTop])}
      onPointerMove={(event) => focus.setHovered(binUnder(event))}
      onPointerLeave={() => focus.setHovered(null)}
      onClick={(event) => {
        const bin = binUnder(event);
        if (bin === null) return;
        if (onSelect && isAdditive(event)) onSelect(toggle(selected, cellsIn([bin], projection)));
        else focus.click(bin, false);
      }}
      onKeyDown={focus.press}
    >
      {children}
      <div ref={element} style={px({ ...total })} />
    </div>
  );
}

interface TilesProps extends Omit<GalleryProps, "query"> {
  shape: Shape;
  side: number;
  scroll: Offset;
  size: Size;
  marked: number | null;
}

/** The canvas with the visible tiles; it moves while it is on the screen. */
function VisibleTiles({ run, at, projection, selected: cells, ...props }: TilesProps) {
  const { colouring, shape, side, scroll, size, marked } = props;
  const canvas = useRef<HTMLCanvasElement>(null);
  const theme = useTheme();
  const { tiles } = projection;
  const bins = useMemo(
    () => visibleBins(tiles.keys(), shape, side, { left: scroll[0], top: scroll[1], ...size }),
    [tiles, side, scroll, size.width, size.height],
  );
  const visible = bins.map((bin) => tiles.get(bin)!).map(({ cell, elite }) => ({ cell, ...elite }));
  const poses = usePoses(run === null ? null : readArchiveBatch(run, at), visible);
  const selected = useMemo(() => binsOf(cells, projection), [cells, projection]);
  const choices = useKnownChoices(run ?? "");
  const chosen = useMemo(() => new Set(choices?.items.map(({ creature }) => creature)), [choices]);
  const picture = { shape, side, tiles, bins, colouring, poses, theme, marked, selected, chosen };
  const complete = visible.length > 0 && visible.every(({ creature }) => poses.has(creature));
  useSteps(useOnScreen(canvas), (steps) => {
    const element = canvas.current; // Null in the frame after the page was left.
    if (element && size.width > 0) drawGallery(element, size, picture, scroll, steps);
  });
  useEffect(() => {
    if (complete) performance.mark("gallery");
  }, [complete]);
  return <canvas ref={canvas} style={px({ ...size })} />;
}

interface RailProps {
  axis: MapAxis;
  side: "x" | "y";
  /** In pixels. */
  offset: number;
  length: number;
  /** The visible length; the name of the axis is in its middle. */
  view: number;
}

/** An axis that scrolls with the gallery. */
function AxisRail({ axis, side, offset, length, view }: RailProps) {
  const place = side === "x" ? px({ width: length, left: offset }) : px({ height: length, top: offset });
  return (
    <div class={`axis-rail gallery-${side}`}>
      <div style={{ ...place, "--middle": `${view / 2 - offset}px` }}>
        <AxisLabels axis={axis} side={side} />
      </div>
    </div>
  );
}

/** Scroll just enough to show the whole tile. */
function scrollToTile(port: HTMLElement, [left, top]: [number, number], side: number): void {
  const { scrollLeft, scrollTop, clientWidth, clientHeight } = port;
  port.scrollTo({
    left: Math.min(left, Math.max(scrollLeft, left + side - clientWidth)),
    top: Math.min(top, Math.max(scrollTop, top + side - clientHeight)),
  });
}

interface GalleryPicture {
  shape: Shape;
  side: number;
  tiles: Tiles;
  /** The bins to draw. */
  bins: readonly number[];
  colouring: Colouring;
  poses: ReadonlyMap<string, PoseStream>;
  theme: Theme;
  marked: number | null;
  /** The selected bins; null without a selection. */
  selected: ReadonlySet<number> | null;
  /** Creatures that people chose to breed. */
  chosen: ReadonlySet<string>;
}

const INKS = {
  light: { body: BODY_INK.light, quiet: "rgb(18 34 44 / 0.3)", tint: 0.3, chosen: "#b3263e" },
  dark: { body: BODY_INK.dark, quiet: "rgb(240 244 246 / 0.3)", tint: 0.38, chosen: "#ff8da0" },
};

/** `steps` are the simulated steps so far; the window starts at `left` and `top` of the gallery. */
function drawGallery(
  canvas: HTMLCanvasElement,
  size: Size,
  picture: GalleryPicture,
  [left, top]: readonly [number, number],
  steps: number,
): void {
  const context = prepare(canvas, size);
  const { side, theme } = picture;
  context.lineJoin = context.lineCap = "round";
  context.lineWidth = Math.max(1.25, side / 32);
  for (const bin of picture.bins) {
    const [x, y] = cornerOf(bin, picture.shape, side);
    drawTile(context, picture, bin, [x - left, y - top, side], steps);
  }
  if (picture.marked === null) return;
  const [x, y] = cornerOf(picture.marked, picture.shape, side);
  context.strokeStyle = INKS[theme].body;
  context.lineWidth = 2;
  context.strokeRect(x - left + 1, y - top + 1, side - 2, side - 2);
}

function drawTile(
  context: CanvasRenderingContext2D,
  { tiles, colouring, poses, theme, selected, chosen }: GalleryPicture,
  bin: number,
  [left, top, side]: readonly [number, number, number],
  steps: number,
): void {
  const { body, quiet, tint } = INKS[theme];
  const tile = tiles.get(bin)!;
  const position = colourPosition(colouring, tile);
  context.fillStyle = position === null ? quiet : css(sequential(position, colouring.palette));
  const strength = !selected || selected.has(bin) ? 1 : FADED;
  context.globalAlpha = tint * strength;
  context.fillRect(left + 1, top + 1, side - 2, side - 2);
  context.globalAlpha = strength;
  context.fillRect(left + 1, top + side - 4, side - 2, 3);
  const stream = poses.get(tile.elite.creature);
  if (stream) {
    traceBody(context, stream, steps, [left, top, side - 3]);
    context.strokeStyle = body;
  } else {
    context.beginPath();
    context.arc(left + side / 2, top + side / 2, 2, 0, 2 * Math.PI);
    context.strokeStyle = quiet;
  }
  context.stroke();
  if (tile.elite.trusted === false) {
    const { lineWidth } = context;
    markDistrusted(context, [left + side - 9, top + 9], 3, theme);
    context.lineWidth = lineWidth;
  }
  if (chosen.has(tile.elite.creature)) markChosen(context, [left + 5, top + 4], Math.max(8, side / 7), theme);
  context.globalAlpha = 1;
}

/** A filled heart with its top left corner at a place. */
function markChosen(
  context: CanvasRenderingContext2D,
  [left, top]: readonly [number, number],
  width: number,
  theme: Theme,
): void {
  const [middle, dip, low] = [left + width / 2, top + width * 0.28, top + width * 0.95];
  context.beginPath();
  context.moveTo(middle, low);
  context.bezierCurveTo(
    left - width * 0.35,
    top + width * 0.45,
    left + width * 0.1,
    top - width * 0.25,
    middle,
    dip,
  );
  context.bezierCurveTo(
    left + width * 0.9,
    top - width * 0.25,
    left + width * 1.35,
    top + width * 0.45,
    middle,
    low,
  );
  context.fillStyle = INKS[theme].chosen;
  context.fill();
}
