/** The event that a request was refused because nobody is signed in. */

export const SIGNED_OUT = "microcosmos:signed-out";

let signedOut = false;

export const isSignedOut = () => signedOut;

export function noteStatus(status: number): void {
  if (status !== 401 || signedOut) return;
  signedOut = true;
  globalThis.dispatchEvent?.(new Event(SIGNED_OUT));
}
