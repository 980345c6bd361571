/** Every request may find out that nobody is signed in: the frame of the page is told. */

export const SIGNED_OUT = "microcosmos:unknown";

let signedOut = false;

export const isSignedOut = () => signedOut;

export function noteStatus(status: number): void {
  if (status !== 401 || signedOut) return;
  signedOut = true;
  globalThis.dispatchEvent?.(new Event(SIGNED_OUT));
}
