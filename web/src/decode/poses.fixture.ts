/** The bytes of a small pose stream, for tests. */

const edge: [number, number] = [0, 1];

export const header = {
  format: "microcosmos-poses/1",
  creature: "ab",
  frames: 2,
  nodes: 2,
  moments: 3,
  edges: [edge],
  size: [24, 16],
  start: 40,
  stop: 60,
  strokes: 2,
  steps: 60,
  scale: 0.5,
  length: 2,
};

/** Units of `scale` cells from the middle of each frame. */
const units = [-2, 0, 2, 0, -2, 4, 2, -32767];
const middles = [10, 20, 50_010, 20];
export const cells = [9, 20, 11, 20, 50_009, 22, 50_011, -16363.5];
export const path = [10, 20, 11, 20, 12, 20];

export function poseBytes(head: object = header): ArrayBuffer {
  const text = new TextEncoder().encode(JSON.stringify(head).padEnd(280));
  const length = new Uint8Array(Uint32Array.of(text.length).buffer);
  const arrays = [Float32Array.from([...path, ...middles]), Int16Array.from(units)].map(
    ({ buffer }) => new Uint8Array(buffer),
  );
  return Uint8Array.of(...length, ...text, ...arrays[0]!, ...arrays[1]!).buffer;
}
