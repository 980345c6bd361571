/** A creature's page: replays of the second format, what they show, networks, relatives. */

import { describe, expect, it } from "vitest";
import type { Ancestors, Creature, Genes, Relative, Spec, Vector } from "../src/api/types";
import { layeredOf } from "../src/frames/layers";
import { networkOf } from "../src/frames/network";
import { ROWS, picturesOf, shareOf, sightOf } from "../src/frames/pictures";
import { type Header, type Replay, decodeReplay } from "../src/frames/replay";
import { anglesOf, lengthsOf } from "../src/frames/shape";
import { treeOf } from "../src/view/family/tree";
import { formOf, groupsOf } from "../src/view/facts";
import { meant } from "../src/view/replay/clock";
import { coloursOf, fieldOf, fieldsOf } from "../src/view/replay/fields";
import { lookOf, queryOf } from "../src/view/replay/look";
import { Moment } from "../src/view/replay/moment";
import { Tracers, velocityAt } from "../src/view/replay/tracers";
import { walked } from "../src/view/space/Heat";
import cases from "./fixtures/networks.json";

const header = {
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
} as unknown as Header;
// An elbow that is straight at the start and turns by a right angle to the left.
const positions = [0, 0, 1, 0, 2, 0, 0, 0, 1, 0, 1, 1.5];
const [angles, lengths] = [
  [0.25, 0.5],
  [1, 1, 1.25, 1],
];
const planes = [1, 2, 3, 4, 10, 20, 30, 40, 50, 60, 70, 80, 0, 255];

function bytes(head: object, floats: number[], levels: number[]): ArrayBuffer {
  let text = JSON.stringify(head);
  while ((4 + text.length) % 4) text += " ";
  const whole = new Uint8Array(4 + text.length + 4 * floats.length + levels.length);
  new DataView(whole.buffer).setUint32(0, text.length, true);
  whole.set(new TextEncoder().encode(text), 4);
  whole.set(new Uint8Array(Float32Array.from(floats).buffer), 4 + text.length);
  whole.set(levels, 4 + text.length + 4 * floats.length);
  return whole.buffer;
}

const replay = decodeReplay(bytes(header, [...positions, ...angles, ...lengths], planes));

describe("a replay of the second format", () => {
  it("holds rest shapes, velocity and energy", () => {
    expect([...replay.positions]).toEqual(positions);
    expect([...replay.drive!.angles]).toEqual(angles);
    expect([...replay.drive!.lengths]).toEqual(lengths);
    expect([...replay.vorticity]).toEqual([1, 2, 3, 4]);
    expect([...replay.drive!.velocity]).toEqual([10, 20, 30, 40, 50, 60, 70, 80]);
    expect([...replay.drive!.energy]).toEqual([0, 255]);
  });

  it("is refused where a plane is missing", () => {
    const short = bytes(header, [...positions, ...angles, ...lengths], planes.slice(1));
    expect(() => decodeReplay(short)).toThrow("2 frames need");
  });

  it("tells angles and lengths, asked for and done, from the start on", () => {
    const turned = anglesOf(replay);
    expect([...turned.asked.values]).toEqual([0.25, 0.5]);
    expect(turned.done.values[1]).toBeCloseTo(Math.PI / 2, 6);
    const stretched = lengthsOf(replay);
    expect([...stretched.asked.values]).toEqual([0, 0, 0.25, 0]);
    expect([...stretched.done.values]).toEqual([0, 0, 0, 0.5]);
  });

  it("shows the speed of both parts of the velocity", () => {
    const field = fieldOf("speed", [replay], "light")!;
    const value = field.plane(replay, 0)[0]! * field.quantum(replay);
    expect(value).toBeCloseTo(0.01 * Math.hypot(10, 30), 2);
    expect(field.range[0]).toBe(0);
    expect(coloursOf(field, replay)).toHaveLength(256);
  });

  it("offers the fields it has", () => {
    expect(fieldsOf([replay])).toEqual(["vorticity", "speed", "energy", "none"]);
    const { drive: _, ...old } = replay;
    const first = { ...old, header: { ...header, energy: undefined } } as unknown as Replay;
    expect(fieldsOf([first])).toEqual(["vorticity", "none"]);
  });
});

/** A box in which everything turns as a wave across x: u = 0, v = sin of x. */
function waving(frames: number, size: [number, number], speed: number): Replay {
  const [width, height] = size;
  const cells = width * height;
  const velocity = new Int8Array(2 * frames * cells);
  for (let frame = 0; frame < frames; frame++) {
    for (let x = 0; x < width; x++) {
      const level = Math.round(127 * Math.sin((2 * Math.PI * x) / width));
      velocity.fill(level, (2 * frame + 1) * cells + x * height, (2 * frame + 1) * cells + (x + 1) * height);
    }
  }
  const told = { ...header, frames, size, every: 10, velocity: { scale: speed } };
  return { ...replay, header: told, drive: { ...replay.drive!, velocity } };
}

describe("tracers", () => {
  const flow = waving(5, [32, 16], 0.1);

  it("read the velocity between cells, across the borders of the box", () => {
    const [u, v] = velocityAt(flow, 1.5, 8, 3.25);
    expect(u).toBe(0);
    expect(v).toBeCloseTo(0.1, 6);
    expect(velocityAt(flow, 0, 32 + 8, -16)[1]).toBeCloseTo(0.1, 6);
    expect(velocityAt(flow, 0, 31.5, 0)[1]).toBeCloseTo(-0.05 * Math.sin(Math.PI / 16), 3);
  });

  it("go with the flow for as long as it takes, whatever was looked at before", () => {
    const [there, back] = [new Tracers(flow), new Tracers(flow)];
    const [start, end] = [there.at(0), there.at(4)];
    for (let i = 0; i < start.length; i += 2) {
      expect(end[i]).toBeCloseTo(start[i]!, 5);
      const [, v] = velocityAt(flow, 0, start[i]!, 0);
      expect(end[i + 1]! - start[i + 1]!).toBeCloseTo(40 * v, 4);
    }
    for (const frame of [1, 2, 3, 4]) back.at(frame);
    expect(back.at(4)).toEqual(end);
  });
});

describe("the moment of a replay", () => {
  it("steps to the next whole frame and stops there", () => {
    const moment = new Moment(true);
    moment.move(2.4);
    moment.step(1, 10);
    expect([moment.time, moment.playing]).toEqual([3, false]);
    moment.step(-1, 10);
    expect(moment.time).toBe(2);
    moment.scrub(9.5);
    moment.step(1, 10);
    moment.step(1, 10);
    expect(moment.time).toBe(10);
  });

  it("is looked at as the address says", () => {
    const change = { field: "speed", tracers: true, follow: false, speed: 4 } as const;
    const words = Object.entries(queryOf(change)).filter(([, word]) => word !== null);
    expect(lookOf(new URLSearchParams(words as [string, string][]))).toEqual(change);
    expect(lookOf(new URLSearchParams("field=heat&pace=3")).speed).toBe(1);
    expect(lookOf(new URLSearchParams("field=heat")).field).toBeNull();
  });
});

describe("what a network computes", () => {
  cases.forEach(({ genome, steps, said }, number) => {
    it(`is what the engine computes, network ${number + 1}`, () => {
      const inherited = genome as unknown as Genes & Vector;
      const network = "nodes" in genome ? networkOf(inherited) : layeredOf(inherited)!;
      const { values } = picturesOf(network, genome.control as unknown as Spec, steps);
      const outputs = network.neurons.filter(({ role }) => role === "output");
      outputs.forEach(({ id }, output) => {
        [0, 5, 31, 95].forEach((column, i) => {
          [0, 17, 30, 47].forEach((row, k) => {
            const expected = said[output]![i]![k]!;
            const found = values.get(id)![column * ROWS + row]!;
            expect(Math.abs(found - expected)).toBeLessThan(2e-4 * Math.max(1, Math.abs(expected)));
          });
        });
      });
    });
  });

  it("depends on the energy it senses", () => {
    const { genome, steps } = cases[0]!;
    const sensing = { ...genome.control, sense_energy: true } as unknown as Spec;
    const genes = {
      encoding: "cppn",
      control: sensing,
      inputs: ["position", "sine", "cosine", "energy"],
      outputs: ["rest_angle"],
      nodes: { id: [0, 1, 2, 3, 4], activation: Array(5).fill("identity"), bias: base64([0, 0, 0, 0, 0]) },
      connections: { innovation: [0], source: [3], target: [4], enabled: [true], weight: base64([2]) },
    } as Genes;
    const { values } = picturesOf(networkOf(genes), sensing, steps, 0.75);
    expect(new Set(values.get(4))).toEqual(new Set([1.5]));
  });

  it("has its cursor in phase, also where a memory is shown from the middle of a period", () => {
    const recurrent = sightOf({ period: 30, recurrent: true });
    const at = (step: number, from: number) => shareOf(step, { from, to: from + 30 }, recurrent);
    expect(at(75, 70)).toBeCloseTo(5 / 30);
    expect(at(69, 70)).toBeCloseTo(29 / 30);
    expect(at(10, 70)).toBe(0);
    expect(at(75, 0)).toBeCloseTo(0.5);
    const linear = sightOf({ timer: "linear", period: 30 });
    expect(shareOf(75, { from: 0, to: 100 }, linear)).toBe(0.75);
  });
});

describe("the keys of a replay", () => {
  // Nothing here draws: an element is what it is within, and the selectors it answers to.
  const element = (selectors: string[], within: object[] = []) => {
    const self = { closest: (asked: string) => (selectors.some((one) => asked.includes(one)) ? self : null) };
    return Object.assign(self, { within }) as unknown as Element;
  };
  const player = {
    contains: (inside: unknown) => (inside as { within: object[] }).within.includes(player),
  } as unknown as Element;

  it("work within the player, and the space bar alone elsewhere", () => {
    const [inside, outside] = [element([], [player]), element([])];
    for (const key of [",", ".", "Home", "End", "ArrowLeft", "ArrowRight"]) {
      expect([meant(key, inside, player), meant(key, outside, player)]).toEqual([true, false]);
    }
    expect(meant(" ", outside, player)).toBe(true);
    expect(meant("Home", inside, null)).toBe(false);
  });

  it("are left to what needs them itself", () => {
    const button = element(["button"], [player]);
    expect([meant(" ", button, player), meant("Home", button, player)]).toEqual([false, true]);
    const choice = element(["select"], [player]);
    expect([meant(" ", choice, player), meant("End", choice, player)]).toEqual([false, false]);
  });
});

describe("a picture over time and space", () => {
  const cells = { columns: 5, rows: 3 };

  it("is read by arrow keys from the moment shown on, and no further than its edges", () => {
    expect(walked("ArrowUp", null, 2, cells)).toEqual({ column: 2, row: 0 });
    expect(walked("ArrowDown", null, 2, cells)).toEqual({ column: 2, row: 2 });
    expect(walked("ArrowRight", null, 2, cells)).toEqual({ column: 3, row: 0 });
    expect(walked("ArrowLeft", { column: 0, row: 1 }, 4, cells)).toEqual({ column: 0, row: 1 });
    expect(walked("ArrowUp", { column: 4, row: 2 }, 0, cells)).toEqual({ column: 4, row: 2 });
    expect(walked("Home", { column: 4, row: 2 }, 0, cells)).toBeNull();
  });
});

const base64 = (values: number[]) =>
  btoa(String.fromCharCode(...new Uint8Array(Float32Array.from(values).buffer)));

describe("a family tree", () => {
  const person = (creature: string, distance: number, parents: string[] = [], fitness = 1): Relative => ({
    creature,
    distance,
    parents,
    fitness,
    kept: true,
    operator: "neat",
    generation: 1,
    credit: [],
  });
  const me = person("me", 0, ["a", "b"]);
  const ancestors: Ancestors = {
    parents: ["a", "b"],
    items: [person("a", 1, ["old"]), person("b", 1, ["old"]), person("old", 2)],
    more: false,
  };

  it("stands in columns, the oldest first, joined as parent and child", () => {
    const tree = treeOf(me, ancestors, { total: 1, items: [person("child", 1, ["me"])] });
    expect(tree.columns.map(({ title }) => title)).toEqual([
      "Grandparents",
      "Parents",
      "This creature",
      "Children",
    ]);
    const lines = tree.lines.map(
      ([parent, child]) => `${parent.relative.creature} ${child.relative.creature}`,
    );
    expect(lines.sort()).toEqual(["a me", "b me", "me child", "old a", "old b"]);
  });

  it("draws the first children, which are the fittest, and says how many it leaves out", () => {
    const items = Array.from({ length: 12 }, (_, i) => person(`c${i}`, 1, ["me"], 11 - i));
    const tree = treeOf(me, ancestors, { total: 30, items });
    const drawn = tree.kin.filter(({ relative }) => relative.creature.startsWith("c"));
    expect(drawn.map(({ relative }) => relative.fitness)).toEqual([11, 10, 9, 8, 7, 6, 5, 4]);
    expect(tree.hidden).toBe(22);
  });
});

describe("facts", () => {
  const creature = {
    identity: { genome: { encoding: "fold" }, world: { fluid: false, coupling: { layers: 1 } } },
    measured: { fitness: 1, descriptors: {}, features: { displacement: 2, mach: 0.1, connections: 4 } },
  } as unknown as Creature;

  it("stand in groups, each once", () => {
    const groups = groupsOf(creature);
    expect(groups.map(({ title }) => title)).toEqual(["Result", "Network", "Flow"]);
    expect(groups.flatMap(({ rows }) => rows).map(([name]) => name)).toEqual([
      "Fitness",
      "Displacement",
      "Connections",
      "Mach number",
    ]);
  });

  it("say nothing of the coupling where there is no fluid", () => {
    expect(formOf(creature)).toEqual([]);
  });
});
