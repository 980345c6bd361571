import { describe, expect, it } from "vitest";
import type { Genes } from "../api/types";
import { decodeFloats } from "./floats";
import { networkOf } from "./network";
import { decodeReplay, solidColumns } from "./replay";
import { angles, header, lengths, positions, replayBytes } from "./replay.fixture";
import { anglesOf, lengthsOf } from "./shape";

const base64 = (bytes: number[]) => btoa(String.fromCharCode(...bytes));
const floats = (values: number[]) => base64([...new Uint8Array(Float32Array.from(values).buffer)]);

describe("base64 floats", () => {
  it("are read as little-endian float32", () => {
    // 1.5 is 0x3fc00000 and -2 is 0xc0000000.
    const text = base64([0, 0, 0xc0, 0x3f, 0, 0, 0, 0xc0]);
    expect([...decodeFloats(text)]).toEqual([1.5, -2]);
  });

  it("are refused if bytes are missing", () => {
    expect(() => decodeFloats(base64([1, 2, 3]))).toThrow("multiple of 4 bytes, got 3");
  });
});

describe("a replay", () => {
  const replay = decodeReplay(replayBytes());

  it("holds positions, rest shapes, signed vorticity, velocity and energy", () => {
    expect(replay.header.frames).toBe(2);
    expect([...replay.positions]).toEqual(positions);
    expect([...replay.angles]).toEqual(angles);
    expect([...replay.lengths]).toEqual(lengths);
    expect([...replay.vorticity]).toEqual([1, 127, -1, -127]);
    expect([...replay.velocity]).toEqual([10, 20, 30, 40, 50, 60, 70, 80]);
    expect([...replay.energy]).toEqual([0, 255]);
  });

  it("that is too short is refused with both sizes", () => {
    const whole = replayBytes();
    const short = whole.slice(0, whole.byteLength - 1);
    expect(() => decodeReplay(short)).toThrow(
      `2 frames need ${whole.byteLength} bytes, got ${short.byteLength}`,
    );
  });

  it("gives the solid cells as columns along y", () => {
    expect(solidColumns([1, 2, 4, 3, 2], 4)).toEqual([
      [0, 1, 2],
      [1, 3, 1],
      [2, 0, 2],
    ]);
    expect(solidColumns([0, 12], 4)).toEqual([
      [0, 0, 4],
      [1, 0, 4],
      [2, 0, 4],
    ]);
    expect(solidColumns([], 4)).toEqual([]);
  });

  it("of another format is refused", () => {
    expect(() => decodeReplay(replayBytes({ ...header, format: "other/9" }))).toThrow("got other/9");
  });

  it("gives rest and actual angles and lengths as changes from the start", () => {
    const turned = anglesOf(replay);
    expect([...turned.rest.values]).toEqual([0.25, 0.5]);
    expect(turned.actual.values[1]).toBeCloseTo(Math.PI / 2, 6);
    const stretched = lengthsOf(replay);
    expect([...stretched.rest.values]).toEqual([0, 0, 0.25, 0]);
    expect([...stretched.actual.values]).toEqual([0, 0, 0, 0.5]);
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

  it("keeps weights, biases, names and disabled links", () => {
    const { neurons, links } = networkOf(genome);
    expect(neurons[2]).toMatchObject({ role: "output", label: "rest angle", bias: 0.5 });
    expect(neurons[4]).toMatchObject({ role: "hidden", label: "", activation: "gaussian" });
    expect(links[3]).toEqual({ source: 1, target: 3, weight: 4, enabled: false });
  });
});
