/** The archive as a gallery of moving creatures, placed by their descriptors. */

import type { ComponentChildren, RefObject } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Motion } from "../decode/motion";
import { useClock } from "../replay/clock";
import { type Size, useSize, prefersReducedMotion, useTheme } from "../ui/canvas";
import { AxisLabels } from "./AxisLabels";
import { type ArchiveViewProps, useBinFocus } from "./binFocus";
import { ColourLegend } from "./ColourLegend";
import { type GalleryPicture, drawGallery } from "./drawGallery";
import { EliteMeasures } from "./EliteMeasures";
import { type Shape, cornerOf, visibleBins } from "./geometry";
import type { Projection } from "./projection";
import { binsOf, cellsIn, isAdditive, keyHelp, toggle } from "./selection";
import { text } from "./text";

interface Props extends ArchiveViewProps {
  /** Side of a tile in pixels; null for the largest that fits. */
  side: number | null;
  motions: ReadonlyMap<string, Motion>;
  /** Called with the visible creatures, sorted from the middle. */
  onSee: (creatures: string[]) => void;
  onSide: (side: number) => void;
  /** Called with the selected size when the slider is released. */
  onSettle: (side: number) => void;
}

const [SMALLEST, LARGEST] = [36, 180];
/** Smaller tiles are hard to read: the gallery scrolls instead. */
const MIN_READABLE = 52;
/** Duration of a loop. */
const SECONDS = 5;

const bounded = (side: number) => Math.min(LARGEST, Math.max(SMALLEST, side));

export function Gallery(props: Props) {
  const { axes, projection, colouring, onOpen } = props;
  const shape: Shape = [axes[0].bins, axes[1].bins];
  const port = useRef<HTMLDivElement>(null);
  const size = useSize(port);
  const [scroll, setScroll] = useState<Offset>([0, 0]);
  const side = bounded(props.side ?? Math.max(MIN_READABLE, Math.floor(size.width / shape[0])));
  const wall = [side * shape[0], side * shape[1]] as const;
  const shown = { width: Math.min(size.width, wall[0]), height: Math.min(size.height, wall[1]) };
  const focus = useBinFocus(props, (bin) => scrollToTile(port.current!, cornerOf(bin, shape, side), side));
  const seen = useSeen({ projection, shape, side, scroll, size }, props.onSee);
  const picture = { shape, side, seen, focused: focus.focused, size: shown, scroll };
  const binUnder = (event: MouseEvent): number | null => {
    const box = port.current!.getBoundingClientRect();
    const x = (event.clientX - box.left + scroll[0]) / wall[0];
    const y = (event.clientY - box.top + scroll[1]) / wall[1];
    const bin = projection.layout.at(x, y);
    return bin !== null && projection.tiles.has(bin) ? bin : null;
  };
  return (
    <div class="gallery" data-gallery>
      <TileSize side={side} onSide={props.onSide} onSettle={props.onSettle} />
      <div class="gallery-frame">
        <AxisRail class="gallery-y" by={-scroll[1]} length={wall[1]} shown={shown.height} upright>
          <AxisLabels axis={axes[1]} side="y" />
        </AxisRail>
        <Port {...props} {...{ port, focus, binUnder }} onScroll={setScroll}>
          <Tiles {...props} {...picture} />
          <div style={{ width: `${wall[0]}px`, height: `${wall[1]}px` }} />
        </Port>
        <AxisRail class="gallery-x" by={-scroll[0]} length={wall[0]} shown={shown.width}>
          <AxisLabels axis={axes[0]} side="x" />
        </AxisRail>
      </div>
      <ColourLegend colouring={colouring} />
      <EliteMeasures
        {...{ axes, onOpen }}
        tile={focus.tile}
        colour={colouring.measure}
        hint={text.galleryHint}
        actions={props.actions}
      />
    </div>
  );
}

type Offset = readonly [left: number, top: number];

interface Seen {
  projection: Projection;
  shape: Shape;
  side: number;
  scroll: Offset;
  size: Size;
}

/** The filled bins in the window; `onSee` gets their creatures. */
function useSeen({ projection: { tiles }, shape, side, scroll, size }: Seen, onSee: Props["onSee"]) {
  const seen = useMemo(() => {
    const window = { left: scroll[0], top: scroll[1], ...size };
    return visibleBins(tiles.keys(), shape, side, window);
  }, [tiles, side, scroll, size]);
  useEffect(() => onSee(seen.map((bin) => tiles.get(bin)!.elite.creature)), [seen]);
  return seen;
}

interface SizeProps extends Pick<Props, "onSide" | "onSettle"> {
  side: number;
}

function TileSize({ side, onSide, onSettle }: SizeProps) {
  return (
    <label class="compact gallery-size">
      {text.tileSize}
      <input
        type="range"
        min={SMALLEST}
        max={LARGEST}
        value={side}
        onInput={(event) => onSide(event.currentTarget.valueAsNumber)}
        onChange={(event) => onSettle(event.currentTarget.valueAsNumber)}
      />
    </label>
  );
}

interface PortProps extends Props {
  port: RefObject<HTMLDivElement | null>;
  focus: ReturnType<typeof useBinFocus>;
  binUnder: (event: MouseEvent) => number | null;
  onScroll: (scroll: Offset) => void;
  children: ComponentChildren;
}

/** The scrolling window, with pointer and keys. */
function Port({ port, focus, binUnder, onScroll, children, ...props }: PortProps) {
  const { projection, selected, onSelect, onOpen } = props;
  return (
    <div
      ref={port}
      class={`gallery-port ${focus.hovered === null ? "" : "over"}`}
      tabIndex={0}
      role="application"
      aria-label={text.galleryLabel(keyHelp(props))}
      aria-describedby="elite-measures"
      onScroll={({ currentTarget: { scrollLeft, scrollTop } }) => onScroll([scrollLeft, scrollTop])}
      onPointerMove={(event) => focus.setHovered(binUnder(event))}
      onPointerLeave={() => focus.setHovered(null)}
      onClick={(event) => {
        const bin = binUnder(event);
        if (bin === null) return;
        if (onSelect && isAdditive(event)) onSelect(toggle(selected, cellsIn([bin], projection)));
        else onOpen(projection.tiles.get(bin)!.cell);
      }}
      onKeyDown={focus.press}
    >
      {children}
    </div>
  );
}

interface TilesProps extends Props {
  shape: Shape;
  side: number;
  seen: number[];
  focused: number | null;
  size: Size;
  scroll: Offset;
}

/** The canvas with the visible tiles. */
function Tiles({ projection, colouring, motions, shape, side, seen, focused, size, ...props }: TilesProps) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const theme = useTheme();
  const selected = useMemo(() => binsOf(props.selected, projection), [props.selected, projection]);
  const { tiles } = projection;
  const content = { shape, side, tiles, colouring, motions, theme, selected };
  useAnimation(canvas, size, { ...content, bins: seen, marked: focused }, props.scroll);
  return <canvas ref={canvas} style={{ width: `${size.width}px`, height: `${size.height}px` }} />;
}

interface RailProps {
  class: string;
  /** Scroll offset in pixels. */
  by: number;
  length: number;
  /** The visible length; the name of the axis is in its middle. */
  shown: number;
  upright?: boolean;
  children: ComponentChildren;
}

/** An axis that scrolls with the gallery. */
function AxisRail({ class: name, by, length, shown, upright = false, children }: RailProps) {
  const style = upright
    ? { height: `${length}px`, transform: `translateY(${by}px)` }
    : { width: `${length}px`, transform: `translateX(${by}px)` };
  const middle = `${shown / 2 - by}px`;
  return (
    <div class={`axis-rail ${name}`}>
      <div style={{ ...style, "--middle": middle }}>{children}</div>
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

/** Redraw the gallery in every frame while it is on the screen, otherwise after each change. */
function useAnimation(
  canvas: RefObject<HTMLCanvasElement | null>,
  size: Size,
  picture: GalleryPicture,
  scroll: readonly [number, number],
): void {
  const share = useRef(0);
  const onScreen = useOnScreen(canvas);
  const draw = () => {
    const element = canvas.current; // Null in the frame after the page was left.
    if (element && size.width > 0) drawGallery(element, size, picture, scroll, share.current);
  };
  useClock(onScreen && !prefersReducedMotion(), (seconds) => {
    share.current = (share.current + seconds / SECONDS) % 1;
    draw();
  });
  useEffect(draw);
}

function useOnScreen(element: RefObject<HTMLElement | null>): boolean {
  const [seen, setSeen] = useState(false);
  useEffect(() => {
    const observer = new IntersectionObserver(([entry]) => setSeen(entry!.isIntersecting));
    observer.observe(element.current!);
    return () => observer.disconnect();
  }, [element]);
  return seen;
}
