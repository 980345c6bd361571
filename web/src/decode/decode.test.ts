import { describe, expect, it } from "vitest";
import type { Genes } from "../api/types";
import { decodeFloats } from "./base64";
import { networkOf } from "./network";
import { decodeReplay } from "./replay";

const base64 = (bytes: number[]) => btoa(String.fromCharCode(...bytes));
const floats = (values: number[]) => base64([...new Uint8Array(Float32Array.from(values).buffer)]);

describe("base64 floats", () => {
  it("are read as little-endian float32", () => {
    // 1.5 is 0x3fc00000 and -2 is 0xc0000000.
    const text = base64([0, 0, 0xc0, 0x3f, 0, 0, 0, 0xc0]);
    expect([...decodeFloats(text)]).toEqual([1.5, -2]);
  });

  it("are refused where bytes are missing", () => {
    expect(() => decodeFloats(base64([1, 2, 3]))).toThrow("multiple of 4 bytes, got 3");
  });
});

function replayBytes(header: object, positions: number[], vorticity: number[]): ArrayBuffer {
  let text = JSON.stringify(header);
  while ((4 + text.length) % 4) text += " ";
  const bytes = new Uint8Array(4 + text.length + 4 * positions.length + vorticity.length);
  new DataView(bytes.buffer).setUint32(0, text.length, true);
  bytes.set(new TextEncoder().encode(text), 4);
  bytes.set(new Uint8Array(Float32Array.from(positions).buffer), 4 + text.length);
  bytes.set(vorticity, 4 + text.length + 4 * positions.length);
  return bytes.buffer;
}

describe("a replay", () => {
  const header = { format: "microcosmos-replay/1", frames: 2, nodes: 1, size: [2, 1] };
  const positions = [0.5, 1.25, -3, 4];

  it("is split into positions and signed vorticity", () => {
    const replay = decodeReplay(replayBytes(header, positions, [1, 127, 255, 129]));
    expect(replay.header.frames).toBe(2);
    expect([...replay.positions]).toEqual(positions);
    expect([...replay.vorticity]).toEqual([1, 127, -1, -127]);
  });

  it("that is cut short is refused with both sizes", () => {
    const whole = replayBytes(header, positions, [0, 0, 0, 0]);
    const short = whole.slice(0, whole.byteLength - 1);
    expect(() => decodeReplay(short)).toThrow(
      `2 frames need ${whole.byteLength} bytes, got ${short.byteLength}`,
    );
  });

  it("of another format is refused", () => {
    const bytes = replayBytes({ ...header, format: "other/9" }, positions, [0, 0, 0, 0]);
    expect(() => decodeReplay(bytes)).toThrow("got other/9");
  });
});

describe("a network", () => {
  const genome: Genes = {
    encoding: "cppn",
    control: {},
    inputs: ["position", "sine"],
    outputs: ["rest_angle", "rest_length"],
    nodes: {
      id: [0, 1, 2, 3, 4, 5],
      activation: ["identity", "identity", "tanh", "sin", "gaussian", "abs"],
      bias: floats([0, 0, 0.5, -0.5, 1, 2]),
    },
    connections: {
      innovation: [0, 1, 2, 3, 4],
      source: [0, 4, 5, 1, 5],
      target: [4, 5, 2, 3, 4],
      enabled: [true, true, true, false, false],
      weight: floats([1, 2, 3, 4, 5]),
    },
  };

  it("has each node one layer beyond the last of its sources, cycles notwithstanding", () => {
    const { neurons } = networkOf({
      ...genome,
      connections: { ...genome.connections, source: [0, 4, 5, 1, 0], target: [4, 5, 2, 3, 5] },
    });
    expect(neurons.map(({ depth }) => depth)).toEqual([0, 0, 3, 3, 1, 2]);
    expect(networkOf(genome).depth).toBeLessThan(genome.nodes.id.length);
  });

  it("with cycles of any length has no more layers than its longest way without one", () => {
    const ring = { ...genome.connections, source: [0, 4, 5, 4, 1], target: [4, 5, 4, 4, 3] };
    const { neurons } = networkOf({ ...genome, connections: ring });
    expect(neurons.map(({ depth }) => depth)).toEqual([0, 0, 2, 2, 1, 2]);
  });

  it("keeps weights, biases, names and what is switched off", () => {
    const { neurons, links } = networkOf(genome);
    expect(neurons[2]).toMatchObject({ role: "output", label: "rest angle", bias: 0.5 });
    expect(neurons[4]).toMatchObject({ role: "hidden", label: "", activation: "gaussian" });
    expect(links[3]).toEqual({ source: 1, target: 3, weight: 4, enabled: false });
  });
});
