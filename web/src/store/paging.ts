/** A list that is read page by page. */

import { useEffect, useRef, useState } from "preact/hooks";
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
  /** Load the next page, unless one is loaded just now; null after the last one. */
  more: (() => void) | null;
  replace: (changed: T) => void;
}

type Read<T> = (cursor?: string) => Promise<Page<T>>;

/** Reads the first page or, with a cursor, the next one; `show` gets it, and the cursor. */
export function pagesOf<T>(
  read: Read<T>,
  show: (page: Page<T>, cursor?: string) => void,
  fail: (reason: unknown) => void,
) {
  let newest = 0;
  let loading = false;
  return async (cursor?: string): Promise<void> => {
    if (cursor !== undefined && loading) return;
    loading = true;
    const request = ++newest;
    try {
      const page = await read(cursor);
      if (request === newest) show(page, cursor);
    } catch (reason) {
      if (request === newest) fail(reason);
    }
    if (request === newest) loading = false; // Otherwise the list was begun anew.
  };
}

/** The list is read again after every reset of the store. */
export function usePages<T>(read: Read<T>, key: (item: T) => string): Pages<T> {
  const [page, setPage] = useState<Page<T> | null>(null);
  const [error, setError] = useState<string | null>(null);
  const epoch = useStore((state) => state.epoch);
  const show = ({ items, next }: Page<T>, cursor?: string) => {
    setPage((old) => ({ items: [...((cursor !== undefined && old?.items) || []), ...items], next }));
    setError(null);
  };
  const load = useRef(pagesOf(read, show, (reason) => setError(messageOf(reason)))).current;
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
