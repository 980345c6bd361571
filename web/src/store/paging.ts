/** A list that is read page by page. */

import { useEffect, useState } from "preact/hooks";
import { messageOf } from "../api/problem";
import { useStore } from "./store";

interface Page<T> {
  items: T[];
  next: string | null;
}

export interface Pages<T> {
  /** Null before the first page. */
  items: T[] | null;
  error: string | null;
  /** Load the next page; null after the last one. */
  more: (() => void) | null;
  replace: (changed: T) => void;
}

/** The list is read again after every reset of the store. */
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
