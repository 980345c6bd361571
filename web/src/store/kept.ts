/** Values that the browser keeps, as JSON. */

/** A kept value, or `otherwise`; storage may be forbidden, and another program may have written it. */
export function readKept<T>(key: string, otherwise: T, storage = () => localStorage): T {
  try {
    return (JSON.parse(storage().getItem(key) ?? "null") as T | null) ?? otherwise;
  } catch {
    return otherwise;
  }
}

/** Change a kept value as it is now, since another tab may have changed it; return the new one. */
export function changeKept<T>(
  key: string,
  otherwise: T,
  change: (now: T) => T,
  storage = () => localStorage,
): T {
  const next = change(readKept(key, otherwise, storage));
  keep(key, next, storage);
  return next;
}

/** Keep a value; where storage is full or forbidden, it lasts as long as the page. */
export function keep(key: string, value: unknown, storage = () => localStorage): void {
  try {
    storage().setItem(key, JSON.stringify(value));
  } catch {
    // The value is a convenience: nothing else depends on it.
  }
}
