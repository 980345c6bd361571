/** Creatures that swim on after their evaluation, in water that visitors change. */

import type { EvaluationInputs } from "../decode/evaluation";
import {
  type Rest,
  type Swimmer,
  fromFirstBox,
  joined,
  REST,
  STATE,
  swimmerOf,
  together,
  within,
  writeRest,
} from "./swimmer";
import { type Area, Kernel, type Results } from "./kernel";
import { FORCES, GIVEN, type Named, PLANE } from "./simulation";
import { text } from "./text";
import {
  type Forces,
  type Place,
  type Plane,
  forced,
  freest,
  pushed,
  quantised,
  shortest,
  sideFor,
  velocities,
  vorticity,
} from "./water";

/** The present state, as a replay of one frame holds it. */
export interface Frame {
  /** Positions (node, 2) of the nodes that have grown, in cells, from the box of the first body. */
  positions: Float32Array;
  /** Pairs of these nodes. */
  edges: [number, number][];
  /** The number of nodes of the first creature, which the view follows. */
  leader: number;
  vorticity: Int8Array;
  velocity: Int8Array;
  scales: { vorticity: number; velocity: number };
}

/** Facts that stay the same while creatures swim. */
export interface Stage {
  size: [number, number];
  viscosity: number;
  /** Steps of a stroke of the first creature. */
  stroke: number;
}

/** The place of the viscosity among the parameters of a rollout. */
const VISCOSITY = 0;
/** Most steps at a time. */
const MOST = 64;
/** The place of the positions among the results, after the planes. */
const POSITIONS = 9;
/** The force of a pull, in lattice units for each cell to the pointer, and the largest. */
const [STIFFNESS, STRONGEST] = [0.005, 0.05];

export class Swim {
  readonly stage: Stage;
  private readonly swimmers: Swimmer[];
  private kernel!: Kernel;
  private numbers!: Record<string, number>;
  private operands!: Named;
  private nothing!: Area;
  private state!: Results;
  private spare!: Results;
  private scratch!: Record<Rest, Area>;
  private forces!: Forces;
  /** Nodes that have grown. */
  private grown!: number[];
  /** Recorded steps of a stroke in each step. */
  speed = 1;

  /** Evaluate a creature, and stand at the end. */
  constructor(
    private readonly module: WebAssembly.Module,
    inputs: EvaluationInputs,
  ) {
    const first = swimmerOf(module, inputs);
    const { height, width } = first.numbers;
    const viscosity = first.arrays.get("parameters")![VISCOSITY]!;
    this.stage = { size: [height!, width!], viscosity, stroke: first.stroke };
    this.swimmers = [first];
    this.begin(first.planes);
  }

  set viscosity(viscosity: number) {
    this.kernel.view(this.operands.get("parameters")!)[VISCOSITY] = viscosity;
  }

  /** Evaluate another creature and put it where most room is; throws an error if there is none for it. */
  join(inputs: EvaluationInputs): void {
    const other = swimmerOf(this.module, inputs);
    joined([...this.swimmers, other]); // Whether it fits, before anything changes.
    const positions = together(other);
    const present = other.arrays.get("present")!;
    const grown = positions.filter((_, i) => present[Math.floor(i / 2)]);
    if (!grown.every(Number.isFinite)) throw new Error(text.diverged);
    const mean = meanPlace(grown);
    const body = grown.map((place, i) => place - mean[i % 2]!);
    const { size } = this.stage;
    const [needed, side] = [sideFor(body), Math.min(...size)];
    if (needed > side) throw new Error(text.tooLarge(needed, side));
    const place = freest(this.positions(), size, body, this.swimmers[0]!.arrays.get("walls")!);
    if (!place) throw new Error(text.noRoom);
    other.arrays.set(
      "positions",
      positions.map((at, i) => at + place[i % 2]! - mean[i % 2]!),
    );
    const boxes = this.boxes();
    other.arrays.set(
      "boxes",
      (other.arrays.get("boxes") as Float32Array).map((_, i) => boxes[i % 2]!),
    );
    const planes = this.planes().map((plane) => plane.slice());
    this.keep();
    this.swimmers.push(other);
    this.begin(planes);
  }

  /** Take steps, with the rest shapes of the last strokes again and again. */
  advance(steps: number): void {
    for (let left = steps; left > 0;) {
      const taken = Math.min(left, MOST);
      this.take(taken);
      for (const swimmer of this.swimmers) swimmer.step = within(swimmer, swimmer.step + taken * this.speed);
      left -= taken;
    }
  }

  /** Push the water at a distance from the first creature, in cells, by a velocity in cells a step. */
  push(away: Place, velocity: Place): void {
    pushed(this.planes(), this.stage.size, this.from(away), velocity);
  }

  /** Pull a grown node for one step, towards a place at a distance from the first creature. */
  pull(node: number, away: Place): void {
    const positions = this.kernel.view(this.state[POSITIONS]!);
    const at = 2 * this.grown[node]!;
    const from: Place = [positions[at]!, positions[at + 1]!];
    const to = this.from(away);
    const way = shortest([to[0] - from[0], to[1] - from[1]], this.stage.size);
    const each = Math.min(STIFFNESS, STRONGEST / Math.max(1e-9, Math.hypot(...way)));
    const force: Place = [each * way[0], each * way[1]];
    // The body has no mass: all of the force acts on the water, where the body moves it.
    positions[at]! += force[0];
    positions[at + 1]! += force[1];
    forced(this.planes(), this.stage.size, from, force);
  }

  frame(): Frame {
    const flow = velocities(this.planes(), this.forces);
    const [curl, vorticityScale] = quantised([vorticity(flow, this.stage.size)]);
    const [velocity, velocityScale] = quantised(flow);
    return {
      positions: this.positions(),
      edges: this.grownEdges(),
      leader: this.leader(),
      vorticity: curl,
      velocity,
      scales: { vorticity: vorticityScale, velocity: velocityScale },
    };
  }

  /** Put all creatures into a new kernel, whose memory holds nothing else. */
  private begin(planes: Plane[]): void {
    const kernel = (this.kernel = new Kernel(this.module));
    const { numbers, arrays } = joined(this.swimmers);
    this.numbers = { ...numbers, commands: GIVEN };
    this.operands = new Map([...arrays].map(([name, values]) => [name, kernel.put(values)]));
    this.nothing = kernel.put(new Float32Array(0));
    const [uniform, across, along, walls] = FORCES.map((name) => arrays.get(name)!);
    this.forces = { uniform: uniform!, across: across!, along: along!, walls: walls! };
    const put = (name: string, values: Float32Array) => ({ ...kernel.put(values), name });
    this.state = [
      ...planes.map((plane) => put(PLANE, plane)),
      ...STATE.map((name) => put(name, arrays.get(name) as Float32Array)),
    ];
    this.spare = [];
    const room = (of: string) => kernel.put(new Float32Array(MOST * numbers[of]!));
    this.scratch = { "rest angles": room("joints"), "rest lengths": room("edges") };
    this.grown = [...arrays.get("present")!.keys()].filter((node) => arrays.get("present")![node]);
  }

  /** Keep the present state of each creature with it. */
  private keep(): void {
    for (const [name, counted, each] of [
      ["positions", "nodes", 2],
      ["angles", "edges", 1],
      ["boxes", "bodies", 2],
      ["collected", "nodes", 1],
    ] as const) {
      const all = this.kernel.read(this.state.find((result) => result.name === name)!);
      let at = 0;
      for (const { arrays, numbers } of this.swimmers) {
        const items = all.length > 0 ? each * numbers[counted]! : 0;
        arrays.set(name, all.slice(at, at + items));
        at += items;
      }
    }
    const energy = this.state.find(({ name }) => name === "energy")!;
    this.swimmers[0]!.arrays.set("energy", this.kernel.read(energy));
  }

  private take(steps: number): void {
    const { state } = this;
    const present = new Map(
      state.slice(POSITIONS, POSITIONS + STATE.length).map((area) => [area.name, area]),
    );
    this.state = this.kernel.call(
      "rollout",
      { ...this.numbers, steps },
      (place, name, items) => {
        if (items === 0) return this.nothing;
        if (name === PLANE) return state[place];
        if ((REST as string[]).includes(name)) return this.rows(name as Rest, items, steps);
        return present.get(name) ?? this.operands.get(name);
      },
      this.spare,
    );
    this.spare = state;
  }

  /** The rest shapes of the next steps. */
  private rows(name: Rest, items: number, steps: number): Area {
    const area = { ...this.scratch[name], items };
    const to = this.kernel.view(area);
    let at = 0;
    for (let step = 0; step < steps; step++) {
      for (const swimmer of this.swimmers) {
        at += writeRest(swimmer, name, swimmer.step + step * this.speed, to.subarray(at));
      }
    }
    return area;
  }

  /** The place at a distance from the first creature. */
  private from([dx, dy]: Place): Place {
    const [x, y] = meanPlace(this.positions().subarray(0, 2 * this.leader()));
    return [x + dx, y + dy];
  }

  /** The number of grown nodes of the first creature. */
  private leader(): number {
    return this.grown.filter((node) => node < this.swimmers[0]!.numbers.nodes!).length;
  }

  /** Positions of grown nodes, from the corner of the first body's box. */
  private positions(): Float32Array {
    const all = this.kernel.view(this.state[POSITIONS]!);
    const member = this.kernel.readIntegers(this.operands.get("member")!);
    const places = fromFirstBox(all, this.boxes(), member, this.stage.size);
    return Float32Array.from(this.grown.flatMap((node) => [places[2 * node]!, places[2 * node + 1]!]));
  }

  /** Whole boxes (body, 2) that bodies have passed. */
  private boxes(): Float32Array {
    return this.kernel.view(this.state.find(({ name }) => name === "boxes")!);
  }

  private planes(): Plane[] {
    return this.state.slice(0, POSITIONS).map((area) => this.kernel.view(area));
  }

  private grownEdges(): [number, number][] {
    const ends = this.kernel.readIntegers(this.operands.get("edges")!);
    const row = new Map(this.grown.map((node, number) => [node, number]));
    const found: [number, number][] = [];
    for (let edge = 0; edge < ends.length; edge += 2) {
      const [one, other] = [row.get(ends[edge]!), row.get(ends[edge + 1]!)];
      if (one !== undefined && other !== undefined) found.push([one, other]);
    }
    return found;
  }
}

function meanPlace(places: ArrayLike<number>): Place {
  const sum: Place = [0, 0];
  for (let i = 0; i < places.length; i++) sum[i % 2]! += places[i]!;
  return [(2 * sum[0]) / places.length, (2 * sum[1]) / places.length];
}
