/** A cache of replays and pose streams, limited by their size. */

import type { PoseStream } from "../decode/poses";
import type { Replay } from "../decode/replay";

const MAX_BYTES = 64e6;

const bytesOf = (value: PoseStream | Replay) =>
  value.positions.byteLength + ("vorticity" in value ? value.vorticity.buffer.byteLength : 0);

/** Set a value as the newest, and drop the oldest ones beyond the limit. */
export function setNewest<T extends PoseStream | Replay>(cache: Map<string, T>, sha: string, value: T): void {
  cache.delete(sha);
  cache.set(sha, value);
  let total = [...cache.values()].reduce((sum, each) => sum + bytesOf(each), 0);
  for (const [oldest, each] of cache) {
    if (total <= MAX_BYTES || oldest === sha) break;
    cache.delete(oldest);
    total -= bytesOf(each);
  }
}
