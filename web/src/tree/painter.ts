/** The worker of a tree: it arranges rows once and paints pictures, one at a time. */

import type { Size, Theme } from "../ui/canvas";
import type { Chains, TreeLayout } from "./layout";
import type { ColourBy } from "./shades";
import type { Scales, View } from "./view";

/** A picture around the middle of a view; it is larger than the window. */
export interface Picture {
  kind: "paint";
  view: View;
  scales: Scales;
  size: Size;
  density: number;
  at: number;
  whole: boolean;
  by: ColourBy;
  theme: Theme;
}

/** Arrange all creatures, or those alone whose line leads to an elite of today. */
interface Arrange {
  kind: "arrange";
  /** The columns; without them the same tree is arranged anew. */
  buffer?: ArrayBuffer;
  survivors: boolean;
}

export type Request = Arrange | Picture;

export interface Arranged {
  layout: TreeLayout;
  chains: Chains;
}

type Answer = ({ kind: "arranged" } & Arranged) | { kind: "painted"; picture: Picture; bitmap: ImageBitmap };

interface Handlers {
  arranged: (found: Arranged) => void;
  painted: (picture: Picture, bitmap: ImageBitmap) => void;
  failed: (message: string) => void;
}

export type Painter = ReturnType<typeof startPainter>;

export function startPainter({ arranged, painted, failed }: Handlers) {
  const worker = new Worker(new URL("./tree.worker.ts", import.meta.url), { type: "module" });
  /** Arrangements that are under way: pictures of an earlier one are dropped. */
  let arranging = 0;
  let painting = false;
  let wanted: Picture | null = null;
  const next = () => {
    if (painting || arranging > 0 || !wanted) return;
    painting = true;
    worker.postMessage(wanted);
    wanted = null;
  };
  worker.onmessage = ({ data }: MessageEvent<Answer>) => {
    if (data.kind === "arranged") {
      arranging--;
      if (arranging === 0) arranged(data);
    } else {
      painting = false;
      if (arranging === 0) painted(data.picture, data.bitmap);
    }
    next();
  };
  worker.onerror = (event) => failed(event.message);
  return {
    arrange: (request: Omit<Arrange, "kind">) => {
      arranging++;
      wanted = null;
      worker.postMessage({ kind: "arrange", ...request });
    },
    /** Paint a picture once the worker is free; a later request takes its place. */
    paint: (picture: Omit<Picture, "kind">) => {
      wanted = { kind: "paint", ...picture };
      next();
    },
    stop: () => worker.terminate(),
  };
}
