/** A warning that only this machine can open the address of a share. */

import { text } from "./text";

const LOOPBACK = ["127.0.0.1", "localhost", "[::1]"];

export const isLoopback = (url: string) => LOOPBACK.includes(new URL(url, location.origin).hostname);

export function Unreachable({ url }: { url: string }) {
  if (!isLoopback(url)) return null;
  return (
    <p class="banner warning" role="note">
      {text.unreachable} <code>MICROCOSMOS_PUBLIC_URL</code>
      {text.unreachableHow}
    </p>
  );
}
