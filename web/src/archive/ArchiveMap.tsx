/** The archive as a map of its elites. */

import type { ComponentChildren } from "preact";
import { useLayoutEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Elite, Elites } from "../store/elites";
import { type ArchiveViewProps, tileUnder, useBinFocus } from "./binFocus";
import { EliteMeasures } from "./EliteMeasures";
import { AxisLabels, ColourLegend } from "./labels";
import type { Layout, Position } from "./layout";
import { useMapCanvas, FADED } from "./mapCanvas";
import { type Size, useSize, prepare, px, useOnScreen, useTheme } from "../ui/canvas";
import { type Region, binsOf, binsWithin, cellsIn, isAdditive, toggle, union, regionOf } from "./selection";
import { text } from "./text";
import { useListener } from "../store/polling";
import { useSteps } from "../replay/clock";
import { BODY_INK } from "../replay/motion";
import { traceBody } from "../replay/poses";
import { readArchiveBatch, usePoses } from "../store/poses";
import { luminance, sequential } from "../ui/colours";
import { type Colouring, colourPosition } from "./colouring";
import type { Projection, Tile } from "./projection";

interface Props extends ArchiveViewProps {
  elites: Elites;
  /** The run whose cells these are; null if they are others. */
  run: string | null;
  /** The generation shown; null for the newest. */
  at: number | null;
  /** Called with the elite under the pointer, or the marked one. */
  onFocus: (elite: Elite | null) => void;
  /** Shown beside the focused cell. */
  inset: ComponentChildren;
  /** Shown while no cell is focused, if not the hint of the page. */
  hint?: string;
}

/** Cells belong to the archive, bins to the map; a bin shows its best elite. */
export function ArchiveMap(props: Props) {
  const { axes, onFocus } = props;
  const focus = useBinFocus(props);
  const { tile } = focus;
  useLayoutEffect(() => onFocus(tile?.elite ?? null), [tile?.elite]);
  return (
    <div class="map">
      <AxisLabels axis={axes[1]} side="y" />
      <MapPlot {...props} focus={focus} />
      <AxisLabels axis={axes[0]} side="x" />
      <ColourLegend colouring={props.colouring} />
      <EliteMeasures {...props} tile={tile} hint={props.hint ?? text.mapHint(props.onSelect !== null)} />
    </div>
  );
}

/** The canvas, with the outline, the selected region and the inset above it. */
function MapPlot({ focus, ...props }: Props & { focus: ReturnType<typeof useBinFocus> }) {
  const { run, at, projection, elites, colouring, onSelect } = props;
  const { layout, tiles } = projection;
  const { hovered, setHovered, focused } = focus;
  const plot = useRef<HTMLDivElement>(null);
  const drag = useLasso(onSelect !== null, (region, event) => {
    const inside = cellsIn(binsWithin(region, layout, tiles), projection);
    onSelect!(isAdditive(event) ? union(props.selected, inside) : inside);
  });
  const selected = useMemo(
    () =>
      drag.region ? new Set(binsWithin(drag.region, layout, tiles)) : binsOf(props.selected, projection),
    [drag.region, props.selected, projection],
  );
  const size = useSize(plot);
  const canvas = useMapCanvas(size, { layout, tiles, colouring, selected }, elites);
  const click = (event: MouseEvent) => {
    const bin = tileUnder(event, plot.current!, projection);
    if (bin === null || drag.wasDrag()) return;
    if (onSelect && isAdditive(event)) return onSelect(toggle(props.selected, cellsIn([bin], projection)));
    focus.click(bin, (event as PointerEvent).pointerType === "touch");
  };
  return (
    <div
      ref={plot}
      class={`map-plot ${hovered === null ? "" : "over"}`}
      tabIndex={0}
      role="application"
      aria-label={text.mapLabel(onSelect !== null)}
      aria-describedby="elite-measures"
      {...drag.handlers}
      onPointerMove={(event) => {
        if (drag.onMove(event)) setHovered(null);
        else if (event.pointerType !== "touch") setHovered(tileUnder(event, plot.current!, projection));
      }}
      onPointerLeave={() => setHovered(null)}
      onClick={click}
      onKeyDown={(event) => !drag.region && focus.press(event)}
    >
      <canvas ref={canvas} />
      <MapBodies {...{ run, at, projection, colouring, selected, size }} />
      <Marks layout={layout} bin={focus.tile ? focused : null} region={drag.region} />
      {focus.tile && !drag.region && (
        <PlacedBeside position={layout.centre(focused!)} children={props.inset} />
      )}
    </div>
  );
}

/** The outline of the focused bin, and the region that is drawn. */
function Marks({ layout, bin, region }: { layout: Layout; bin: number | null; region: Region | null }) {
  return (
    <svg class="map-mark" viewBox="0 0 1 1" preserveAspectRatio="none" aria-hidden="true">
      {bin !== null && <BinOutline layout={layout} bin={bin} />}
      {region && <polygon class="lasso" points={region.join(" ")} />}
    </svg>
  );
}

/** The polygon around a bin, twice: a wide line in the colour of the card, a narrow one above it. */
function BinOutline({ layout, bin }: { layout: Layout; bin: number }) {
  const points = layout.outline(bin).join(" ");
  return (
    <>
      <polygon class="around" points={points} />
      <polygon points={points} />
    </>
  );
}

/** Content beside a bin, placed so that it hides neither the bin nor much of the map. */
function PlacedBeside({ position: [x, y], children }: { position: Position; children: ComponentChildren }) {
  const place = { "--x": `${100 * x}%`, "--y": `${100 * y}%` };
  return (
    <div class={`map-beside ${x < 0.5 ? "right" : "left"}`} style={place}>
      {children}
    </div>
  );
}

/** The shortest drag, in pixels; shorter movements are clicks. */
const MIN_DISTANCE = 5;

/** `onEnd` gets the region when the button is released. */
function useLasso(enabled: boolean, onEnd: (region: Region, event: PointerEvent) => void) {
  const started = useRef<{ event: PointerEvent; way: Position[] } | null>(null);
  const [region, setRegion] = useState<Region | null>(null);
  const dragged = useRef(false);
  const stop = () => {
    started.current = null;
    setRegion(null);
  };
  useListener("keydown", (event: KeyboardEvent) => {
    if (region && event.key === "Escape") stop();
  });
  return {
    region,
    /** True if a click is the end of a drag. */
    wasDrag: () => dragged.current,
    /** True while a region is drawn. */
    onMove: (event: PointerEvent): boolean => {
      if (started.current && (event.buttons & 1) === 0) stop(); // Released outside.
      if (!started.current) return false;
      const { event: first, way } = started.current;
      const far = Math.hypot(event.clientX - first.clientX, event.clientY - first.clientY);
      if (!dragged.current && far < MIN_DISTANCE) return false;
      if (!dragged.current) (event.currentTarget as Element).setPointerCapture(event.pointerId);
      dragged.current = true;
      way.push(positionOf(event));
      setRegion(regionOf(way));
      return true;
    },
    handlers: {
      onPointerDown: (event: PointerEvent) => {
        dragged.current = false;
        if (!enabled || event.button !== 0 || event.pointerType === "touch") return;
        started.current = { event, way: [positionOf(event)] };
      },
      onPointerUp: (event: PointerEvent) => {
        if (started.current && dragged.current) {
          onEnd(regionOf([...started.current.way, positionOf(event)]), event);
        }
        stop();
      },
      onPointerCancel: stop,
    },
  };
}

/** The position on the element, clipped to [0, 1). */
function positionOf(event: PointerEvent): Position {
  const { left, top, width, height } = (event.currentTarget as Element).getBoundingClientRect();
  const bounded = (share: number) => Math.min(1 - 1e-9, Math.max(0, share));
  return [bounded((event.clientX - left) / width), bounded((event.clientY - top) / height)];
}

/** The smallest cells in which a body can be recognised, in pixels, and the most bodies at a time. */
const [MIN_SIDE, MOST] = [15, 600];
/** Brighter cells have dark bodies: where black and white have the same contrast (WCAG 2.2). */
const BRIGHT = 0.18;

interface MapBodiesProps {
  /** The run of the cells; null if they are no cells of a run. */
  run: string | null;
  /** The generation shown; null for the newest. */
  at: number | null;
  projection: Projection;
  colouring: Colouring;
  /** The selected bins; null without a selection. */
  selected: ReadonlySet<number> | null;
  size: Size;
}

function MapBodies({ run, projection, size, ...props }: MapBodiesProps) {
  const side = Math.sqrt((size.width * size.height) / projection.layout.count);
  if (run === null || side < MIN_SIDE || projection.tiles.size > MOST) return null;
  return <Bodies {...props} {...{ run, projection, size, side }} />;
}

function Bodies({
  run,
  at,
  projection,
  colouring,
  selected,
  size,
  side,
}: MapBodiesProps & { run: string; side: number }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const theme = useTheme();
  const { tiles, layout } = projection;
  const elites = useMemo(
    () => [...tiles.values()].map(({ cell, elite: { creature } }) => ({ cell, creature })),
    [tiles],
  );
  const poses = usePoses(readArchiveBatch(run, at), elites, false);
  const inks = useMemo(
    () => new Map([...tiles].map(([bin, tile]) => [bin, inkOn(tile, colouring)])),
    [tiles, colouring],
  );
  const last = useRef({ steps: 0, frame: 0 });
  useSteps(useOnScreen(canvas), (steps) => {
    const { current } = last;
    // Every other frame is enough for small bodies that move; other changes are drawn at once.
    const moves = steps !== current.steps;
    current.steps = steps;
    if (!canvas.current || (moves && ++current.frame % 2 > 0)) return;
    const context = prepare(canvas.current, size);
    context.lineJoin = context.lineCap = "round";
    context.lineWidth = Math.max(1.2, side / 22);
    for (const [bin, { elite }] of tiles) {
      const stream = poses.get(elite.creature);
      if (!stream) continue;
      const [x, y] = layout.centre(bin);
      traceBody(context, stream, steps, [x * size.width - side / 2, y * size.height - side / 2, side]);
      context.strokeStyle = inks.get(bin) ?? BODY_INK[theme];
      context.globalAlpha = !selected || selected.has(bin) ? 1 : FADED;
      context.stroke();
    }
  });
  return <canvas data-bodies ref={canvas} style={px({ ...size })} />;
}

/** The colour of a body that is legible on its cell; null if the cell has no colour. */
function inkOn(tile: Tile, colouring: Colouring): string | null {
  const position = colourPosition(colouring, tile);
  if (position === null) return null;
  return luminance(sequential(position, colouring.palette)) > BRIGHT ? BODY_INK.light : BODY_INK.dark;
}
