/** Names of creatures: the SHA-256 of an identity's canonical JSON. */

import { canonical } from "./canonical";

export const nameOf = (identity: unknown) => sha256(new TextEncoder().encode(canonical(identity)));

/** The first 32 bits of the fractional parts of the roots of primes. */
const fractions = (primes: number[], power: number) =>
  primes.map((prime) => ((prime ** power % 1) * 2 ** 32) | 0);
const PRIMES = [...Array(312).keys()].filter(
  (n) => n > 1 && [2, 3, 5, 7, 11, 13, 17].every((p) => n === p || n % p),
);
const START = fractions(PRIMES.slice(0, 8), 1 / 2);
const ROUNDS = fractions(PRIMES, 1 / 3);

/** SHA-256 (FIPS 180-4) in hexadecimal: over plain HTTP, browsers offer none. */
export function sha256(bytes: Uint8Array): string {
  const padded = new Uint8Array(64 * Math.ceil((bytes.length + 9) / 64));
  padded.set(bytes);
  padded[bytes.length] = 0x80;
  const view = new DataView(padded.buffer);
  view.setBigUint64(padded.length - 8, 8n * BigInt(bytes.length));
  let state = START;
  for (let at = 0; at < padded.length; at += 64) {
    const mixed = compressed(state, schedule(view, at));
    state = state.map((word, i) => (word + mixed[i]!) | 0);
  }
  return state.map((word) => (word >>> 0).toString(16).padStart(8, "0")).join("");
}

const turn = (word: number, by: number) => (word >>> by) | (word << (32 - by));

/** The words of a block at an offset, and those that follow from them. */
function schedule(view: DataView, at: number): Int32Array {
  const words = new Int32Array(64);
  for (let i = 0; i < 64; i++) {
    const [near, far] = [words[i - 2]!, words[i - 15]!];
    words[i] =
      i < 16
        ? view.getInt32(at + 4 * i)
        : words[i - 16]! +
          (turn(far, 7) ^ turn(far, 18) ^ (far >>> 3)) +
          words[i - 7]! +
          (turn(near, 17) ^ turn(near, 19) ^ (near >>> 10));
  }
  return words;
}

function compressed(state: number[], words: Int32Array): number[] {
  let [a, b, c, d, e, f, g, h] = state as [number, number, number, number, number, number, number, number];
  words.forEach((word, i) => {
    const chosen = (e & f) ^ (~e & g);
    const first = h + (turn(e, 6) ^ turn(e, 11) ^ turn(e, 25)) + chosen + ROUNDS[i]! + word;
    const second = (turn(a, 2) ^ turn(a, 13) ^ turn(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
    [h, g, f, e, d, c, b, a] = [g, f, e, (d + first) | 0, c, b, a, (first + second) | 0];
  });
  return [a, b, c, d, e, f, g, h];
}
