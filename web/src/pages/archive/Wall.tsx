/** The gallery, with the motions of what it shows. */

import type { ComponentChildren } from "preact";
import { useState } from "preact/hooks";
import type { Elite } from "../../live/elites";
import { useMotions } from "../../live/motions";
import { setQuery } from "../../router";
import type { MapAxis } from "../../view/archive/axes";
import type { Choosing } from "../../view/archive/choosing";
import type { Colouring } from "../../view/archive/colouring";
import type { Projection } from "../../view/archive/projection";
import { Gallery } from "../../view/gallery/Gallery";

interface Props extends Choosing {
  axes: readonly [MapAxis, MapAxis];
  projection: Projection;
  colouring: Colouring;
  marked: number | null;
  onMark: (cell: number) => void;
  onOpen: (cell: number) => void;
  actions: (elite: Elite, cell: number) => ComponentChildren;
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
