import { beforeAll, describe, expect, it } from "vitest";
import { deviation, fitnessOf, lastCycle, mean, means, overTrials } from "./evaluate";
import { Kernel, type Results } from "./kernel";
import address from "./kernel.wasm?url&inline";
import { repeated } from "./simulation";

const { fround } = Math;

describe("figures over trials", () => {
  it("are means in single precision, and the largest of what limits a creature", () => {
    const trials = [0.1, 0.2, 0.4].map((x) => ({ speed: fround(x), mach: fround(x), fitness: fround(x) }));
    expect(means(trials, ["mach"])).toMatchObject({
      mach: fround(0.4),
      speed: mean(trials.map((one) => one.speed)),
    });
    const found = overTrials(trials, ["mach"]);
    expect(found.speed).toBeCloseTo(0.7 / 3, 6);
    expect(found.speed).toBe(fround(found.speed!));
    expect(found.mach).toBe(fround(0.4));
    expect(found.trial_spread).toBeCloseTo(0.152753, 6);
  });

  it("of one simulation are its bits, −0 too", () => {
    const one = { wave_direction: -0, mach: fround(0.1) };
    expect(overTrials([means([one], ["mach"])], ["mach"]).wave_direction).toBe(-0);
  });

  it("do not spread in one trial", () => {
    expect(overTrials([{ speed: 1, fitness: 2 }], [])).toEqual({ speed: 1, fitness: 2, trial_spread: 0 });
  });

  it("have the deviation of a sample", () => {
    expect(deviation([1, 2, 3, 4])).toBeCloseTo(Math.sqrt(5 / 3), 6);
    expect(mean([1, 2, 3, 6])).toBe(3);
  });
});

describe("the last cycle", () => {
  const start = Float32Array.of(0.5, 0.5);
  const within = (...centre: number[]) => ({
    centre: Float32Array.from(centre),
    cells: new Float32Array(centre.length),
  });
  const path = within(1, 2, 3, 5, 7, 1);

  it("ends with the simulation, and may be all of it", () => {
    expect(lastCycle(path, start, 2)).toEqual({ cycle_x: 6, cycle_y: -1 });
    expect(lastCycle(path, start, 3)).toEqual({ cycle_x: 6.5, cycle_y: 0.5 });
  });

  it("is in single precision", () => {
    const far = within(0.1, 0, 60.3, 0);
    expect(lastCycle(far, start, 1).cycle_x).toBe(fround(fround(60.3) - fround(0.1)));
  });

  it("may lead into other boxes, however far", () => {
    const route = {
      centre: Float32Array.of(63.5, 1, 0.25, 1),
      cells: Float32Array.of(64e6, 0, 64e6 + 64, -64),
    };
    expect(lastCycle(route, start, 1)).toEqual({ cycle_x: 0.75, cycle_y: -64 });
    const once = { ...route, cells: Float32Array.of(0, 0, 64, -64) };
    expect(lastCycle(once, start, 2)).toEqual({ cycle_x: 63.75, cycle_y: -63.5 });
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
  const SIZES = {
    steps: 1,
    bodies: 1,
    nodes: 2,
    edges: 1,
    joints: 0,
    height: 8,
    width: 8,
    energetic: 0,
    driven: 0,
    varied: 0,
    walled: 0,
  };

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

  describe("counts poses in which edges cross", () => {
    // Two filaments of two nodes: the second turns over the first.
    const edges = [0, 1, 2, 3];
    const apart = [0, 0, 400, 0, 0, 40, 400, 40];
    const across = [0, 0, 400, 0, 200, -200, 200, 200];
    const crossing = (poses: number[][], start: number[], ends = edges, present = [1, 1, 1, 1]) => {
      const one = kernel();
      const frames = Array.from({ length: 64 }, (_, frame) => poses[frame % poses.length]!);
      const given = new Map([
        ["frames", one.put(Float32Array.from(frames.flat()))],
        ["whole", one.put(Int32Array.from(start))],
        ["edges", one.put(Int32Array.from(ends))],
        ["present", one.put(Int32Array.from(present))],
      ]);
      const sizes = { nodes: present.length, edges: ends.length / 2 };
      return one.read(one.call("cross", sizes, (_, name) => given.get(name))[0]!)[0];
    };

    it("as a share", () => {
      expect(crossing([apart, across, across, apart], apart)).toBe(0.5);
      expect(crossing([apart, across, apart], apart)).toBe(fround(21 / 64));
    });

    it("in fewer poses of larger bodies, with the bits of XLA", () => {
      const far = [...Array(749).keys()].flatMap(() => [4, 5]);
      const larger = (pose: number[]) => [...pose, 4000, 4000, 4400, 4000];
      const poses = [...Array(64).keys()].map((frame) => larger(frame < 25 ? across : apart));
      const share = crossing(poses, larger(apart), [...edges, ...far], [1, 1, 1, 1, 1, 1]);
      expect(share).toBe(fround(5 * fround(1 / 12))); // Frames 4, 9, … 59.
    });

    it("without what crosses at the start or has not grown", () => {
      expect(crossing([across], across)).toBe(0);
      expect(crossing([across], apart, edges, [1, 1, 1, 0])).toBe(0);
    });

    it("without edges that share a node", () => {
      const folded = [0, 0, 400, 0, 0, 0];
      expect(crossing([folded], folded, [0, 1, 1, 2], [1, 1, 1])).toBe(0);
    });

    it("and refuses edges of nodes that are missing", () => {
      expect(() => crossing([apart], apart, [0, 1, 2, 4])).toThrow("refers to what it lacks");
    });
  });

  it("measures a body that drifts", () => {
    const one = kernel();
    const zeros = (items: number) => one.put(new Float32Array(items));
    const given = new Map([
      ["a plane", zeros(64)],
      ["positions", one.put(Float32Array.of(3, 4, 4, 4))],
      ["angles", zeros(1)],
      ["edges", one.put(Int32Array.of(0, 1))],
      ["member", one.put(Int32Array.of(0, 0))],
      ["present", one.put(Int32Array.of(1, 1))],
      ["boxes", one.put(Float32Array.of(1e6, -1e6))],
      ["box", one.put(Float32Array.of(1e6, 1 - 1e6))], // It has left its box, which is 8 cells wide.
      ["rest lengths", one.put(Float32Array.of(1))],
      ["centre", one.put(Float32Array.of(3.5, 4.25))],
      ["path", one.put(Float32Array.of(3, 4.25, 4, 4.25))],
      ["force", zeros(2)],
      ["clock", one.put(Float32Array.of(1))],
      ["scales", one.put(Float32Array.of(0.1, 1, 0))],
    ]);
    const single = ["speed", "node speed", "held", "heading", "power"];
    const forces = ["uniform force", "forces across rows", "forces along rows", "walls"];
    const empty = ["joints", "collected", "rest angles", "curvature", ...forces];
    const measured = (reused: Results = []) =>
      one.call(
        "summarise",
        SIZES,
        (_, name) => (single.includes(name) ? zeros(1) : empty.includes(name) ? zeros(0) : given.get(name)),
        reused,
      );
    const found = measured();
    const [displacement] = one.read(found.find(({ name }) => name === "measures")!);
    expect(displacement).toBe(8.25);
    // Results that were shorter at the last call have the room of those before.
    expect(measured(found.map((area) => ({ ...area, items: 1 })))).toEqual(found);
  });
});
