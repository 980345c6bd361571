/** A list that is read page by page, as far as somebody wants it. */

import { useEffect, useState } from "preact/hooks";
import { messageOf } from "../api/problem";
import { useStore } from "./store";

interface Page<T> {
  items: T[];
  next: string | null;
}

export interface Pages<T> {
  /** Null until the first page is there. */
  items: T[] | null;
  error: string | null;
  /** Null where there is no more. */
  more: (() => void) | null;
  /** Puts something that has changed in the place of what it was. */
  replace: (changed: T) => void;
}

/** From its beginning again whenever what was fetched is not to be trusted any more. */
export function usePages<T>(read: (cursor?: string) => Promise<Page<T>>, key: (item: T) => string): Pages<T> {
  const [page, setPage] = useState<Page<T> | null>(null);
  const [error, setError] = useState<string | null>(null);
  const epoch = useStore((state) => state.epoch);
  const load = async (cursor?: string) => {
    try {
      const { items, next } = await read(cursor);
      setPage((old) => ({ items: [...(cursor ? (old?.items ?? []) : []), ...items], next }));
      setError(null);
    } catch (reason) {
      setError(messageOf(reason));
    }
  };
  useEffect(() => void load(), [epoch]);
  const next = page?.next;
  return {
    items: page?.items ?? null,
    error,
    more: next ? () => void load(next) : null,
    replace: (changed) =>
      setPage(
        (old) =>
          old && { ...old, items: old.items.map((item) => (key(item) === key(changed) ? changed : item)) },
      ),
  };
}
