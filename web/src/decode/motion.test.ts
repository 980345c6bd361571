import { describe, expect, it } from "vitest";
import { decodeMotion } from "./motion";

const HEADER = {
  format: "microcosmos-motion/1",
  creature: "ab",
  frames: 3,
  every: 5,
  steps: 10,
  nodes: 1,
  edges: [],
  size: [4, 2],
  vorticity: { scale: 1 },
  moments: 2,
  square: 2,
  scale: 0.5,
};

function bytesOf(header: object, middles: number[], units: number[], levels: number[]): ArrayBuffer {
  const text = JSON.stringify(header);
  const padded = new TextEncoder().encode(text.padEnd(4 * Math.ceil(text.length / 4)));
  const numbers = [Float32Array.from(middles), Int16Array.from(units), Int8Array.from(levels)];
  const parts = [Uint32Array.of(padded.length), padded, ...numbers].map((one) => [
    ...new Uint8Array(one.buffer),
  ]);
  return Uint8Array.from(parts.flat()).buffer;
}

describe("a motion", () => {
  // Two squares along x, at the start and at the end.
  const { header, positions, vorticity } = decodeMotion(
    bytesOf(HEADER, [0, 20, 10, 20, 30, 20], [0, 0, 0, 2, 0, -4], [100, -100, 0, 0]),
  );

  it("holds places in cells", () => {
    expect([...positions]).toEqual([0, 20, 10, 21, 30, 18]);
    expect(header).toMatchObject({ frames: 3, every: 5, size: [4, 2] });
  });

  it("has the fluid between squares and moments", () => {
    const at = (frame: number, x: number) => vorticity[8 * frame + 2 * x];
    // The middles of the squares lie at 0.5 and 2.5 of the cells' middles 0, 1, 2, 3; the world repeats.
    expect([0, 1, 2, 3].map((x) => at(0, x))).toEqual([50, 50, -50, -50]);
    expect([0, 1, 2, 3].map((x) => at(1, x))).toEqual([25, 25, -25, -25]);
    expect(at(2, 0)).toBe(0);
  });
});
