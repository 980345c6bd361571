/** The bytes of a small replay, for tests. */

export const header = {
  format: "microcosmos-replay/2",
  frames: 2,
  nodes: 3,
  every: 5,
  steps: 5,
  edges: [
    [0, 1],
    [1, 2],
  ],
  joints: [[0, 1]],
  size: [2, 1],
  vorticity: { scale: 1 },
  velocity: { scale: 1.27 },
  energy: { scale: 2, frames: 1 },
};

/** An elbow that is straight at the start and turns left by a right angle. */
export const positions = [0, 0, 1, 0, 2, 0, 0, 0, 1, 0, 1, 1.5];
export const angles = [0.25, 0.5];
export const lengths = [1, 1, 1.25, 1];

export function replayBytes(head: object = header): ArrayBuffer {
  const text = new TextEncoder().encode(JSON.stringify(head));
  const floats = Float32Array.from([...positions, ...angles, ...lengths]);
  const planes = [1, 127, 255, 129, 10, 20, 30, 40, 50, 60, 70, 80, 0, 255];
  const size = new Uint8Array(Uint32Array.of(text.length).buffer);
  return Uint8Array.of(...size, ...text, ...new Uint8Array(floats.buffer), ...planes).buffer;
}
