/** Every request may find out that nobody is signed in: the frame of the page is told. */

export const UNKNOWN = "microcosmos:unknown";

let unknown = false;

export const isUnknown = () => unknown;

export function noteStatus(status: number): void {
  if (status !== 401 || unknown) return;
  unknown = true;
  globalThis.dispatchEvent?.(new Event(UNKNOWN));
}
