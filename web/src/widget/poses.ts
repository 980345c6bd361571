/** Pose streams that the kernel has sent, in place of store/poses.ts, which asks a server for them. */

import { useEffect, useMemo, useState } from "preact/hooks";
import { type PoseStream, decodePoseBatch } from "../decode/poses";

/** By creature; widgets of a notebook share them. */
const known = new Map<string, PoseStream>();
const listeners = new Set<() => void>();

/** Keep the streams of a batch, which may be empty, and draw all widgets again. */
export function useKept(batch: DataView): void {
  useMemo(() => keep(batch), [batch]); // At once, because this widget draws them now.
  useEffect(() => {
    for (const listener of listeners) listener();
  }, [batch]);
}

function keep({ buffer, byteOffset, byteLength }: DataView): void {
  const bytes = (buffer as ArrayBuffer).slice(byteOffset, byteOffset + byteLength);
  for (const stream of decodePoseBatch(bytes)) {
    if (!known.has(stream.header.creature)) known.set(stream.header.creature, stream);
  }
}

function useUpdates(): void {
  const [, redraw] = useState(0);
  useEffect(() => {
    const listener = () => redraw((count) => count + 1);
    listeners.add(listener);
    return () => void listeners.delete(listener);
  }, []);
}

/** A notebook has no server to read from. */
export const readArchiveBatch = () => null;

export function usePoses(): ReadonlyMap<string, PoseStream> {
  useUpdates();
  return known;
}

export const loadedStream = (sha: string): PoseStream | null => known.get(sha) ?? null;

export function usePoseStream(sha: string | null) {
  useUpdates();
  return { stream: sha === null ? null : loadedStream(sha), rendering: false, error: null };
}
