/** The archive as a map of its elites. */

import type { ComponentChildren } from "preact";
import { useLayoutEffect, useMemo, useRef } from "preact/hooks";
import type { Elite, Elites } from "../store/elites";
import { type ArchiveViewProps, tileUnder, useBinFocus } from "./binFocus";
import { EliteMeasures } from "./EliteMeasures";
import { AxisLabels, ColourLegend } from "./labels";
import type { Layout, Position } from "./layout";
import { useLasso } from "./lasso";
import { MapBodies } from "./MapBodies";
import { useMapCanvas } from "./mapCanvas";
import { useSize } from "../ui/canvas";
import { type Region, binsOf, binsWithin, cellsIn, isAdditive, toggle, union } from "./selection";
import { text } from "./text";

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
