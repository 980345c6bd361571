/** The stage of a tree, with its worker, in the life of a component. */

import type { RefObject } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { type Phylogeny, decodePhylogeny } from "../decode/phylogeny";
import { useSize } from "../ui/canvas";
import type { Landmark } from "./landmarks";
import { type Arranged, type Painter, startPainter } from "./painter";
import { Stage } from "./stage";

export interface Elements {
  port: RefObject<HTMLDivElement | null>;
  picture: RefObject<HTMLCanvasElement | null>;
  overlay: RefObject<HTMLCanvasElement | null>;
}

/** A tree with the rows of its creatures. */
export interface LoadedTree extends Arranged {
  tree: Phylogeny;
}

export type TreeCanvases = ReturnType<typeof useCanvases>;

/** The stage on the canvases and the worker that paints for it. */
export function useCanvases({ port, picture, overlay }: Elements) {
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
export function useArranged(
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
