/** The gallery, with the motions of what it shows. */

import { useState } from "preact/hooks";
import { useMotions } from "../../live/motions";
import { setQuery } from "../../router";
import type { MapAxis } from "../../view/archive/axes";
import type { Colouring } from "../../view/archive/colouring";
import type { Projection } from "../../view/archive/projection";
import { Gallery } from "../../view/gallery/Gallery";

interface Props {
  axes: readonly [MapAxis, MapAxis];
  projection: Projection;
  colouring: Colouring;
  marked: number | null;
  onMark: (cell: number) => void;
  onOpen: (cell: number) => void;
  query: URLSearchParams;
}

export function Wall({ query, ...props }: Props) {
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
