import { beforeAll, describe, expect, it } from "vitest";
import { crossing } from "./crossing";
import { deviation, fitnessOf, lastCycle, mean, overTrials } from "./figures";
import { Kernel } from "./kernel";
import address from "./kernel.wasm?url&inline";
import { repeated } from "./simulation";

const { fround } = Math;

describe("figures over trials", () => {
  it("are means in single precision, and the largest of what limits a creature", () => {
    const trials = [0.1, 0.2, 0.4].map((x) => ({ speed: fround(x), mach: fround(x), fitness: fround(x) }));
    const found = overTrials(trials);
    expect(found.speed).toBeCloseTo(0.7 / 3, 6);
    expect(found.speed).toBe(fround(found.speed!));
    expect(found.mach).toBe(fround(0.4));
    expect(found.trial_spread).toBeCloseTo(0.152753, 6);
  });

  it("do not spread in one trial", () => {
    expect(overTrials([{ speed: 1, fitness: 2 }])).toEqual({ speed: 1, fitness: 2, trial_spread: 0 });
  });

  it("have the deviation of a sample", () => {
    expect(deviation([1, 2, 3, 4])).toBeCloseTo(Math.sqrt(5 / 3), 6);
    expect(mean([1, 2, 3, 6])).toBe(3);
  });
});

describe("the last cycle", () => {
  const [path, start] = [Float32Array.of(1, 2, 3, 5, 7, 1), Float32Array.of(0.5, 0.5)];

  it("ends with the simulation, and may be all of it", () => {
    expect(lastCycle(path, start, 2)).toEqual({ cycle_x: 6, cycle_y: -1 });
    expect(lastCycle(path, start, 3)).toEqual({ cycle_x: 6.5, cycle_y: 0.5 });
  });

  it("is in single precision", () => {
    const far = Float32Array.of(0.1, 0, 60.3, 0);
    expect(lastCycle(far, start, 1).cycle_x).toBe(fround(fround(60.3) - fround(0.1)));
  });
});

describe("fitness", () => {
  const goal = { displacement: 1, energy: 0, measure: null, sign: 1 };
  const measures = { displacement: 3, energy: 4, cost_of_transport: 5 };

  it("is a measure, or displacement and energy by their weights", () => {
    expect(fitnessOf(goal, measures)).toBe(3);
    expect(fitnessOf({ ...goal, energy: 0.5 }, measures)).toBe(5);
    expect(fitnessOf({ ...goal, displacement: 0, energy: 0.5 }, measures)).toBe(2);
    expect(fitnessOf({ ...goal, measure: "cost_of_transport", sign: -1 }, measures)).toBe(-5);
  });

  it("of a plug-in is unknown", () => {
    expect(fitnessOf(null, measures)).toBeNull();
  });
});

describe("crossing", () => {
  // Two filaments of two nodes: the second turns over the first.
  const edges = Int32Array.of(0, 1, 2, 3);
  const apart = [0, 0, 400, 0, 0, 40, 400, 40];
  const across = [0, 0, 400, 0, 200, -200, 200, 200];
  const body = { edges, present: Int32Array.of(1, 1, 1, 1) };

  it("is the share of poses in which edges cross", () => {
    const frames = Float32Array.from([...apart, ...across, ...across, ...apart]);
    expect(crossing(frames, Int32Array.from(apart), body)).toBe(0.5);
  });

  it("leaves out what crosses at the start or has not grown", () => {
    const frames = Float32Array.from(across);
    expect(crossing(frames, Int32Array.from(across), body)).toBe(0);
    const grown = { edges, present: Int32Array.of(1, 1, 1, 0) };
    expect(crossing(frames, Int32Array.from(apart), grown)).toBe(0);
  });

  it("leaves out edges with a common node", () => {
    const chain = { edges: Int32Array.of(0, 1, 1, 2), present: Int32Array.of(1, 1, 1) };
    const folded = [0, 0, 400, 0, 0, 0];
    expect(crossing(Float32Array.from(folded), Int32Array.from(folded), chain)).toBe(0);
  });
});

describe("copies", () => {
  it("carry out the rest shapes of the first", () => {
    const rest = Float32Array.of(1, 2, 3, 4);
    expect([...repeated(rest, 2, 2)]).toEqual([1, 2, 1, 2, 3, 4, 3, 4]);
  });
});

describe("the kernel", () => {
  let module: WebAssembly.Module;
  beforeAll(async () => {
    module = await WebAssembly.compile(await (await fetch(address)).arrayBuffer());
  });
  const kernel = () => new Kernel(module);
  const SIZES = { steps: 1, bodies: 1, nodes: 2, edges: 1, joints: 0, height: 8, width: 8, energetic: 0 };

  it("names a number that is missing", () => {
    expect(() => kernel().call("rollout", {}, () => undefined)).toThrow("The inputs have no number steps.");
  });

  it("refuses numbers that are wrong", () => {
    const wrong = { ...SIZES, nodes: 0 };
    expect(() => kernel().call("summarise", wrong, () => undefined)).toThrow("at least one step of one node");
  });

  it("names an array of another size", () => {
    const one = kernel();
    const short = one.put(Float32Array.of(1, 2));
    expect(() => one.call("summarise", SIZES, () => short)).toThrow(
      "The array a plane needs 64 items, got 2.",
    );
    expect(() => one.call("summarise", SIZES, () => undefined)).toThrow("needs 64 items, got none");
  });

  it("measures a body that drifts", () => {
    const one = kernel();
    const zeros = (items: number) => one.put(new Float32Array(items));
    const given = new Map([
      ["a plane", zeros(64)],
      ["positions", one.put(Float32Array.of(3, 4, 4, 4))],
      ["angles", zeros(1)],
      ["edges", one.put(Int32Array.of(0, 1))],
      ["present", one.put(Int32Array.of(1, 1))],
      ["rest lengths", one.put(Float32Array.of(1))],
      ["centre", one.put(Float32Array.of(3.5, 4.25))],
      ["path", one.put(Float32Array.of(3, 4.25, 4, 4.25))],
      ["force", zeros(2)],
      ["clock", one.put(Float32Array.of(1))],
      ["scales", one.put(Float32Array.of(0.1, 1, 0))],
    ]);
    const single = ["speed", "node speed", "held", "heading", "power"];
    const empty = ["joints", "collected", "rest angles", "curvature"];
    const found = one.call("summarise", SIZES, (_, name) =>
      single.includes(name) ? zeros(1) : empty.includes(name) ? zeros(0) : given.get(name),
    );
    const [displacement] = one.read(found.find(({ name }) => name === "measures")!);
    expect(displacement).toBe(0.25);
  });
});
