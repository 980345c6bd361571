/** The model of a widget, which the kernel and all its views share. */

import { useEffect, useState } from "preact/hooks";
import type { Archive } from "../api/types";

/** An archive with the centroids of its cells, if it has them, and measures by name. */
export type Shown = Archive & { centroids: number[][] | null };

/** The synchronised fields of `microcosmos.widgets`. */
export interface Fields {
  _kind: "map" | "player";
  _archive: Shown;
  /** Pose streams, each after its length. */
  _poses: DataView;
  /** A replay file; empty for a pose stream. */
  _replay: DataView;
  _creature: string;
  _about: string;
  status: string;
  x: string | null;
  y: string | null;
  colour: string;
  selected: number[];
}

export interface Model {
  get<K extends keyof Fields>(name: K): Fields[K];
  set<K extends keyof Fields>(name: K, value: Fields[K]): void;
  save_changes(): void;
  on(event: string, listener: () => void): void;
  off(event: string, listener: () => void): void;
}

/** A field, drawn again when the kernel or another view changes it. */
export function useField<K extends keyof Fields>(
  model: Model,
  name: K,
): readonly [value: Fields[K], set: (value: Fields[K]) => void] {
  const [value, show] = useState(() => model.get(name));
  useEffect(() => {
    const event = `change:${name}`;
    const listener = () => show(() => model.get(name));
    listener(); // It may have changed before this effect.
    model.on(event, listener);
    return () => model.off(event, listener);
  }, [model, name]);
  const set = (next: Fields[K]) => {
    model.set(name, next);
    model.save_changes();
  };
  return [value, set];
}
