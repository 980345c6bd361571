/** A tree of life in a window: canvases, keys and pointer, with controls around it. */

import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { sharedSlug } from "../api/address";
import { type Phylogeny, NONE, indexOf, isElite, nameAt, decodePhylogeny } from "../decode/phylogeny";
import { TimeSlider } from "../replay/timeControls";
import { readTankBatch, usePoses } from "../store/poses";
import { navigate, setQuery } from "../store/router";
import { useTheme, useSize } from "../ui/canvas";
import { count } from "../ui/format";
import { press, useGestures } from "./gestures";
import type { Landmark } from "./landmarks";
import { type ColourBy, shadesOf } from "./shades";
import { type Shown, Stage } from "./stage";
import { svgOf } from "./svg";
import { TreeLegend, TreeControls } from "./TreeControls";
import { TreeCreature } from "./TreeCreature";
import { text } from "./text";
import type { RefObject } from "preact";
import { type Arranged, type Painter, startPainter } from "./painter";

interface Props {
  buffer: ArrayBuffer;
  /** The path of the run or creature. */
  of: string;
  /** The creature in the middle, if the tree is that of one. */
  self?: string;
  query: URLSearchParams;
}

export function TreeView({ buffer, of, self, query }: Props) {
  const elements: Elements = { port: useRef(null), picture: useRef(null), overlay: useRef(null) };
  const survivors = query.get("show") === "survivors";
  const canvases = useCanvases(elements);
  const loaded = useArranged(buffer, survivors, canvases);
  const view = useShown(loaded, canvases, query, self);
  const stage = () => canvases.parts.current!.stage;
  return (
    <>
      {canvases.error && <p class="banner wrong">{text.failed(canvases.error)}</p>}
      <TreeControls
        {...{ of, survivors }}
        by={view.by}
        whole={view.whole}
        zoom={canvases.zoom}
        stage={stage}
        onDrawing={() => svgOf(stage().scene)}
      />
      <div class="tree-window">
        <TreePort {...{ elements, loaded, view, stage }} />
        {loaded && (
          <TreeCreature
            {...loaded}
            creature={view.focus}
            hrefOf={view.hrefOf}
            side={view.focus !== NONE && stage().isLeft(view.focus) ? "right" : "left"}
          />
        )}
      </div>
      {loaded && (
        <>
          <TimeSlider last={view.last} at={view.at} ready onMove={view.setAt} />
          <TreeLegend tree={loaded.tree} shades={view.shades!} theme={view.theme} collapsed={!view.whole} />
          <Summary {...loaded} />
        </>
      )}
    </>
  );
}

/** The page of the creature whose tree this page of a share shows. */
const selfPage = () => location.pathname.replace(/\/tree\/?$/, "");

type ShownView = ReturnType<typeof useShown>;

/** The choices of the address, the slider and the pointer, passed on to the stage. */
function useShown(loaded: LoadedTree | null, canvases: TreeCanvases, query: URLSearchParams, self?: string) {
  const theme = useTheme();
  const [at, setAt] = useState<number | null>(null);
  const [hovered, setHovered] = useState(NONE);
  const by: ColourBy = query.get("colour") === "operator" ? "operator" : "fitness";
  const whole = query.get("lines") === "all";
  const tree = loaded?.tree;
  const chosen = query.get("creature") ?? self;
  const selected = useMemo(() => placed(loaded, chosen), [loaded, chosen]);
  const focus = hovered === NONE ? selected : hovered;
  // A share holds no motion of ancestors.
  const poses = usePoses(readTankBatch, useNames(sharedSlug ? null : loaded, canvases.landmarks));
  const shown: Shown = { at: at ?? Infinity, whole, by, theme, focus, poses };
  useEffect(() => {
    setHovered(NONE); // Rows are other creatures now.
    const { stage, painter } = canvases.parts.current!;
    if (loaded) stage.load(loaded, painter, { ...shown, focus: selected });
  }, [loaded]);
  useEffect(() => canvases.parts.current!.stage.show(shown));
  const shades = useMemo(() => tree && shadesOf(tree, by, theme), [tree, by, theme]);
  const hrefOf = (creature: number) => {
    if (sharedSlug) return nameAt(tree!, creature) === self ? selfPage() : null;
    const run = tree!.run[creature]!;
    return `/creatures/${nameAt(tree!, creature)}${run === NONE ? "" : `?run=${tree!.runs[run]}`}`;
  };
  const last = tree?.time.at(-1) ?? 0;
  return { theme, at, setAt, by, whole, focus, selected, setHovered, last, shades, hrefOf };
}

/** The creatures with bodies, for their pose streams. */
function useNames(loaded: LoadedTree | null, landmarks: readonly Landmark[]) {
  return useMemo(() => {
    if (!loaded) return [];
    return landmarks.map(({ creature }) => ({ creature: nameAt(loaded.tree, creature) }));
  }, [landmarks]);
}

/** The row of a creature in the tree as it is arranged. */
function placed(loaded: LoadedTree | null, name: string | undefined): number {
  const found = loaded && name ? indexOf(loaded.tree, name) : NONE;
  return found !== NONE && loaded!.layout.row[found] !== NONE ? found : NONE;
}

interface PortProps {
  elements: Elements;
  loaded: LoadedTree | null;
  view: ShownView;
  stage: () => Stage;
}

function TreePort({ elements: { port, picture, overlay }, loaded, view, stage }: PortProps) {
  const select = (creature: number) => {
    view.setHovered(NONE);
    setQuery({ creature: creature === NONE ? null : nameAt(loaded!.tree, creature) });
  };
  const open = (creature: number) => {
    const page = view.hrefOf(creature);
    if (page) navigate(page);
  };
  useGestures(port, {
    pan: (by) => stage().pan(by),
    zoom: (log, at) => stage().zoom(log, at),
    hover: (at) => view.setHovered(at ? stage().creatureAt(at) : NONE),
    tap: (at, byTouch) => {
      const creature = stage().creatureAt(at);
      // Fingers cannot hover: the first tap selects, the second opens.
      if (creature === NONE || (byTouch && creature !== view.selected)) select(creature);
      else open(creature);
    },
  });
  const onKeyDown = (event: KeyboardEvent) => {
    if (!loaded || event.ctrlKey || event.metaKey || event.altKey) return;
    const selection = { selected: view.selected, select, open };
    if (press(event, loaded, stage(), selection)) event.preventDefault();
  };
  return (
    <div
      ref={port}
      class={`tree-port ${view.focus === NONE ? "" : "over"}`}
      tabIndex={0}
      role="application"
      aria-label={text.label}
      aria-describedby="tree-creature"
      aria-busy={!loaded}
      onKeyDown={onKeyDown}
    >
      <canvas ref={picture} class="tree-picture" />
      <canvas ref={overlay} class="tree-overlay" />
      {!loaded && <p class="quiet loading">{text.arranging}</p>}
      {loaded?.layout.totalRows === 0 && <p class="quiet">{text.noElites}</p>}
    </div>
  );
}

function Summary({ tree, layout }: LoadedTree) {
  const [first, now] = useMemo(() => {
    let [roots, elites] = [0, 0];
    for (let i = 0; i < tree.count; i++) {
      if (layout.parent[i] === NONE) roots++;
      if (isElite(tree, i)) elites++;
    }
    return [roots, elites];
  }, [tree, layout]);
  const alone = tree.count === 1 ? text.one : text.summary(count(tree.count), count(first), count(now));
  return (
    <p class="quiet small">
      {alone} {text.hint}
    </p>
  );
}

interface Elements {
  port: RefObject<HTMLDivElement | null>;
  picture: RefObject<HTMLCanvasElement | null>;
  overlay: RefObject<HTMLCanvasElement | null>;
}

/** A tree with the rows of its creatures. */
export interface LoadedTree extends Arranged {
  tree: Phylogeny;
}

type TreeCanvases = ReturnType<typeof useCanvases>;

/** The stage on the canvases and the worker that paints for it. */
function useCanvases({ port, picture, overlay }: Elements) {
  const parts = useRef<{ stage: Stage; painter: Painter } | null>(null);
  const arranged = useRef<(found: Arranged) => void>(() => {});
  const [zoom, setZoom] = useState(0);
  const [landmarks, setLandmarks] = useState<Landmark[]>([]);
  const [error, setError] = useState<string | null>(null);
  const size = useSize(port);
  useEffect(() => {
    const stage = new Stage({ picture: picture.current!, overlay: overlay.current! }, (zoom, landmarks) => {
      setZoom(zoom);
      setLandmarks(landmarks);
    });
    const painter = startPainter({
      arranged: (found) => arranged.current(found),
      painted: (picture, bitmap) => stage.painted(picture, bitmap),
      failed: setError,
    });
    parts.current = { stage, painter };
    return () => {
      stage.stop();
      painter.stop();
    };
  }, []);
  useEffect(() => parts.current!.stage.resize(size), [size]);
  return { parts, arranged, zoom, landmarks, error };
}

/** Arrange the columns of a tree; null until that is done the first time. */
function useArranged(
  buffer: ArrayBuffer,
  survivors: boolean,
  { parts, arranged }: TreeCanvases,
): LoadedTree | null {
  const [loaded, setLoaded] = useState<LoadedTree | null>(null);
  const sent = useRef<ArrayBuffer | null>(null);
  useEffect(() => {
    const tree = decodePhylogeny(buffer);
    arranged.current = (found) => setLoaded({ tree, ...found });
    parts.current!.painter.arrange({ buffer: sent.current === buffer ? undefined : buffer, survivors });
    sent.current = buffer;
  }, [buffer, survivors]);
  return loaded;
}
