/** The gallery, with the motions of what it shows. */

import type { ComponentChildren } from "preact";
import { useState } from "preact/hooks";
import type { Elite } from "../store/elites";
import { useMotions } from "../store/motions";
import { setQuery } from "../store/router";
import type { MapAxis } from "./axes";
import type { Selection } from "./selection";
import type { Colouring } from "./colouring";
import type { Projection } from "./projection";
import { Gallery } from "./Gallery";

interface Props extends Selection {
  axes: readonly [MapAxis, MapAxis];
  projection: Projection;
  colouring: Colouring;
  marked: number | null;
  onMark: (cell: number) => void;
  onOpen: (cell: number) => void;
  actions: (elite: Elite, cell: number) => ComponentChildren;
  query: URLSearchParams;
}

export function ArchiveGallery({ query, ...props }: Props) {
  const [seen, setSeen] = useState<string[]>([]);
  const [side, setSide] = useState(() => Number(query.get("tile")) || null);
  const motions = useMotions(seen);
  return (
    <Gallery
      {...props}
      {...{ motions, side }}
      onSee={setSeen}
      onSide={setSide}
      onSettle={(settled) => setQuery({ tile: String(settled) })}
    />
  );
}
