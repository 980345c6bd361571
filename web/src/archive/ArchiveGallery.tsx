/** The gallery with the motions of its visible creatures. */

import { useState } from "preact/hooks";
import { useMotions } from "../store/motions";
import { setQuery } from "../store/router";
import type { ArchiveViewProps } from "./binFocus";
import { Gallery } from "./Gallery";

export function ArchiveGallery({ query, ...props }: ArchiveViewProps & { query: URLSearchParams }) {
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
