/** The archive as a wall of moving creatures, each in the place that its descriptors give it. */

import type { ComponentChildren, RefObject } from "preact";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Motion } from "../decode/motion";
import type { Elite } from "../store/elites";
import { HorizontalLabels, VerticalLabels } from "./AxisLabels";
import { binByKey } from "./ArchiveMap";
import type { MapAxis } from "./axes";
import { type Selection, isAdditive, binsOf, cellsIn, selectByKey, keyHelp, toggle } from "./selection";
import type { Colouring } from "./colouring";
import type { Shape } from "./geometry";
import { ColourLegend } from "./ColourLegend";
import { isDirection } from "./layout";
import type { Projection } from "./projection";
import { EliteReading } from "./EliteReading";
import { type Size, useSize } from "../ui/canvas";
import { useClock } from "../replay/clock";
import { prefersStillness, useTheme } from "../ui/theme";
import { type GalleryPicture, drawGallery } from "./drawGallery";
import { cornerOf, visibleBins } from "./galleryTiles";
import { text } from "./text";

interface Props extends Selection {
  axes: readonly [MapAxis, MapAxis];
  projection: Projection;
  colouring: Colouring;
  marked: number | null;
  /** Pixels of a tile's side; null: as large as fits. */
  side: number | null;
  motions: ReadonlyMap<string, Motion>;
  /** The creatures that are seen, from the middle outwards. */
  onSee: (creatures: string[]) => void;
  onSide: (side: number) => void;
  /** The size that was chosen, once the finger is off. */
  onSettle: (side: number) => void;
  onMark: (cell: number) => void;
  onOpen: (cell: number) => void;
  /** What else can be done with an elite. */
  actions: (elite: Elite, cell: number) => ComponentChildren;
}

const [SMALLEST, LARGEST] = [36, 180];
/** Below this, a body is hard to make out: then the wall scrolls rather than fit. */
const READABLE = 52;
/** All of a replay passes in so many seconds. */
const SECONDS = 5;

const bounded = (side: number) => Math.min(LARGEST, Math.max(SMALLEST, side));

export function Gallery(props: Props) {
  const { axes, projection, colouring, marked, motions, onSee, onMark, onOpen, onChoose } = props;
  const { tiles, bins, layout } = projection;
  const shape: Shape = [axes[0].bins, axes[1].bins];
  const port = useRef<HTMLDivElement>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const size = useSize(port);
  const theme = useTheme();
  const [hovered, setHovered] = useState<number | null>(null);
  const [scroll, setScroll] = useState<readonly [number, number]>([0, 0]);
  const side = bounded(props.side ?? Math.max(READABLE, Math.floor(size.width / shape[0])));
  const wall = [side * shape[0], side * shape[1]] as const;
  const shown = { width: Math.min(size.width, wall[0]), height: Math.min(size.height, wall[1]) };
  const from = marked === null ? null : (bins.get(marked) ?? null);
  const looked = hovered !== null && tiles.has(hovered) ? hovered : from;
  const seen = useMemo(() => {
    const window = { left: scroll[0], top: scroll[1], ...size };
    return visibleBins(tiles.keys(), shape, side, window);
  }, [tiles, side, scroll, size]);
  useEffect(() => onSee(seen.map((bin) => tiles.get(bin)!.elite.creature)), [seen]);
  const chosen = useMemo(() => binsOf(props.chosen, projection), [props.chosen, projection]);
  const common = { shape, side, tiles, colouring, motions, theme, chosen };
  const picture: GalleryPicture = { ...common, bins: seen, marked: looked };
  useAnimation(canvas, shown, picture, scroll);

  const binUnder = (event: MouseEvent): number | null => {
    const box = port.current!.getBoundingClientRect();
    const x = (event.clientX - box.left + scroll[0]) / wall[0];
    const y = (event.clientY - box.top + scroll[1]) / wall[1];
    const bin = layout.at(x, y);
    return bin !== null && tiles.has(bin) ? bin : null;
  };
  const press = (event: KeyboardEvent) => {
    if (event.key === "Enter" && from !== null) return onOpen(tiles.get(from)!.cell);
    const next = isDirection(event.key) ? binByKey(event.key, from, tiles, layout) : null;
    const changed = onChoose && selectByKey(event, props.chosen, projection, from, next);
    if (changed) onChoose(changed);
    if (!changed && !isDirection(event.key)) return;
    event.preventDefault();
    setHovered(null);
    if (next === null) return;
    onMark(tiles.get(next)!.cell);
    reveal(port.current!, cornerOf(next, shape, side), side);
  };

  return (
    <div class="gallery" data-gallery>
      <label class="compact gallery-size">
        {text.tileSize}
        <input
          type="range"
          min={SMALLEST}
          max={LARGEST}
          value={side}
          onInput={(event) => props.onSide(event.currentTarget.valueAsNumber)}
          onChange={(event) => props.onSettle(event.currentTarget.valueAsNumber)}
        />
      </label>
      <div class="gallery-frame">
        <AxisRail class="gallery-y" by={-scroll[1]} length={wall[1]} shown={shown.height} upright>
          <VerticalLabels axis={axes[1]} />
        </AxisRail>
        <div
          ref={port}
          class={`gallery-port ${hovered === null ? "" : "over"}`}
          tabIndex={0}
          role="application"
          aria-label={text.galleryLabel(keyHelp(props))}
          aria-describedby="map-reading"
          onScroll={({ currentTarget: { scrollLeft, scrollTop } }) => setScroll([scrollLeft, scrollTop])}
          onPointerMove={(event) => setHovered(binUnder(event))}
          onPointerLeave={() => setHovered(null)}
          onClick={(event) => {
            const bin = binUnder(event);
            if (bin === null) return;
            if (onChoose && isAdditive(event)) onChoose(toggle(props.chosen, cellsIn([bin], projection)));
            else onOpen(tiles.get(bin)!.cell);
          }}
          onKeyDown={press}
        >
          <canvas ref={canvas} style={{ width: `${shown.width}px`, height: `${shown.height}px` }} />
          <div style={{ width: `${wall[0]}px`, height: `${wall[1]}px` }} />
        </div>
        <AxisRail class="gallery-x" by={-scroll[0]} length={wall[0]} shown={shown.width}>
          <HorizontalLabels axis={axes[0]} />
        </AxisRail>
      </div>
      <ColourLegend colouring={colouring} />
      <EliteReading
        tile={looked === null ? undefined : tiles.get(looked)}
        axes={axes}
        colour={colouring.measure}
        hint={text.galleryHint}
        onOpen={onOpen}
        actions={props.actions}
      />
    </div>
  );
}

interface RailProps {
  class: string;
  /** How far the wall is scrolled, in pixels. */
  by: number;
  length: number;
  /** How much of it the window shows: its name stands in the middle of that. */
  shown: number;
  upright?: boolean;
  children: ComponentChildren;
}

/** An axis that scrolls with the wall. */
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

/** Scrolls no farther than it takes to show the whole tile. */
function reveal(port: HTMLElement, [left, top]: [number, number], side: number): void {
  const { scrollLeft, scrollTop, clientWidth, clientHeight } = port;
  port.scrollTo({
    left: Math.min(left, Math.max(scrollLeft, left + side - clientWidth)),
    top: Math.min(top, Math.max(scrollTop, top + side - clientHeight)),
  });
}

/** Draws the wall again and again while it is on the screen; else once for each change. */
function useAnimation(
  canvas: RefObject<HTMLCanvasElement | null>,
  size: Size,
  picture: GalleryPicture,
  scroll: readonly [number, number],
): void {
  const share = useRef(0);
  const onScreen = useOnScreen(canvas);
  const draw = () => {
    const element = canvas.current; // None any more in the frame in which the page is left.
    if (element && size.width > 0) drawGallery(element, size, picture, scroll, share.current);
  };
  useClock(onScreen && !prefersStillness(), (seconds) => {
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
