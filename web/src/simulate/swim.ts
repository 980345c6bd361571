/** A creature that swims on after its evaluation, in water that visitors change. */

import type { EvaluationInputs } from "../decode/evaluation";
import { type Area, Kernel, type Results } from "./kernel";
import { GIVEN, type Named, PLANE, simulated } from "./simulation";
import { type Plane, pushed, quantised, velocities, vorticity } from "./water";

/** The present state, as a replay of one frame holds it. */
export interface Frame {
  /** Positions (node, 2) of the nodes that have grown, in cells. */
  positions: Float32Array;
  vorticity: Int8Array;
  velocity: Int8Array;
  scales: { vorticity: number; velocity: number };
}

/** What stays the same while a creature swims. */
export interface Stage {
  size: [number, number];
  /** Pairs of nodes that have grown. */
  edges: [number, number][];
  viscosity: number;
  /** Steps of a stroke; of the whole simulation for a creature without strokes. */
  stroke: number;
}

/** Steps of the window of the last strokes, in the results of a summary. */
const WINDOW = { start: 3, stop: 4, strokes: 5 };
/** The place of the viscosity among the parameters of a rollout. */
const VISCOSITY = 0;
/** Most steps at a time. */
const MOST = 64;
const PLACES = { planes: 0, positions: 9, angles: 10, energy: 11, collected: 12 };

export class Swim {
  readonly stage: Stage;
  private readonly kernel: Kernel;
  private readonly numbers: Record<string, number>;
  private readonly begin: Named;
  private readonly rest: Named;
  private readonly window: { start: number; stop: number };
  private readonly nodes: number[];
  private readonly parameters: Area;
  private readonly nothing: Area;
  private state: Results;
  private spare: Results = [];
  /** The recorded step at which it is, which may lie between two. */
  private step: number;
  private readonly scratch = new Map<string, Area>();
  /** Recorded steps of its stroke in each step. */
  speed = 1;

  /** Evaluate a creature, and stand at the end. */
  constructor(module: WebAssembly.Module, inputs: EvaluationInputs) {
    const kernel = (this.kernel = new Kernel(module));
    const { begin, end, observed, summary } = simulated(kernel, inputs, inputs.trials[0]![0]!);
    const shown = kernel.read(summary.get("shown")!);
    this.numbers = { ...inputs.numbers.rollout, commands: GIVEN };
    this.begin = begin;
    this.rest = observed;
    this.window = { start: shown[WINDOW.start]!, stop: shown[WINDOW.stop]! };
    this.parameters = kernel.put(kernel.read(begin.get("parameters")!));
    this.nothing = kernel.put(new Float32Array(0));
    this.state = end;
    this.step = this.window.start;
    const present = kernel.readIntegers(begin.get("present")!);
    this.nodes = [...present.keys()].filter((node) => present[node]);
    const { height, width } = this.numbers;
    const viscosity = kernel.view(this.parameters)[VISCOSITY]!;
    const stroke = (this.window.stop - this.window.start) / Math.max(1, shown[WINDOW.strokes]!);
    this.stage = { size: [height!, width!], edges: this.grownEdges(), viscosity, stroke };
  }

  set viscosity(viscosity: number) {
    this.kernel.view(this.parameters)[VISCOSITY] = viscosity;
  }

  /** Take steps, with the rest shapes of the last strokes again and again. */
  advance(steps: number): void {
    for (let left = steps; left > 0;) {
      const taken = Math.min(left, MOST);
      this.take(taken);
      this.step = this.within(this.step + taken * this.speed);
      left -= taken;
    }
  }

  /** Push the water at a distance from the creature, in cells, by a velocity in cells a step. */
  push([dx, dy]: [number, number], velocity: [number, number]): void {
    const places = this.positions();
    const mean = (axis: number) =>
      places.reduce((sum, place, i) => (i % 2 === axis ? sum + place : sum), 0) / (places.length / 2);
    pushed(this.planes(), this.stage.size, [mean(0) + dx, mean(1) + dy], velocity);
  }

  frame(): Frame {
    const flow = velocities(this.planes());
    const [curl, vorticityScale] = quantised([vorticity(flow, this.stage.size)]);
    const [velocity, velocityScale] = quantised(flow);
    return {
      positions: this.positions(),
      vorticity: curl,
      velocity,
      scales: { vorticity: vorticityScale, velocity: velocityScale },
    };
  }

  private positions(): Float32Array {
    const all = this.kernel.view(this.state[PLACES.positions]!);
    return Float32Array.from(this.nodes.flatMap((node) => [all[2 * node]!, all[2 * node + 1]!]));
  }

  private take(steps: number): void {
    const { state } = this;
    const numbers = { ...this.numbers, steps };
    const present: Named = new Map([
      ["positions", state[PLACES.positions]!],
      ["angles", state[PLACES.angles]!],
      ["energy", state[PLACES.energy]!],
      ["collected", state[PLACES.collected]!],
      ["parameters", this.parameters],
    ]);
    this.state = this.kernel.call(
      "rollout",
      numbers,
      (place, name, items) => {
        if (items === 0) return this.nothing;
        if (name === PLANE) return state[PLACES.planes + place];
        if (name === "rest angles" || name === "rest lengths") return this.rows(name, items, steps);
        return present.get(name) ?? this.begin.get(name);
      },
      this.spare,
    );
    this.spare = state;
  }

  /** The rest shapes of the next steps, between the recorded ones. */
  private rows(name: string, items: number, steps: number): Area {
    const each = items / steps;
    const known = this.scratch.get(name) ?? this.kernel.put(new Float32Array(MOST * each));
    this.scratch.set(name, known);
    const area = { address: known.address, items };
    const from = this.kernel.view({ ...this.rest.get(name)!, items: this.window.stop * each });
    const to = this.kernel.view(area);
    for (let step = 0; step < steps; step++) {
      const at = this.within(this.step + step * this.speed);
      const [before, share] = [Math.floor(at), at % 1];
      const after = this.within(before + 1);
      for (let i = 0; i < each; i++) {
        const value = from[before * each + i]!;
        to[step * each + i] = share === 0 ? value : value + share * (from[after * each + i]! - value);
      }
    }
    return area;
  }

  /** A step of the window of the last strokes, which repeat. */
  private within(step: number): number {
    const { start, stop } = this.window;
    return step < stop ? step : start + ((step - start) % (stop - start));
  }

  private planes(): Plane[] {
    return this.state.slice(PLACES.planes, PLACES.planes + 9).map((area) => this.kernel.view(area));
  }

  private grownEdges(): [number, number][] {
    const ends = this.kernel.readIntegers(this.begin.get("edges")!);
    const row = new Map(this.nodes.map((node, number) => [node, number]));
    const found: [number, number][] = [];
    for (let edge = 0; edge < ends.length; edge += 2) {
      const [one, other] = [row.get(ends[edge]!), row.get(ends[edge + 1]!)];
      if (one !== undefined && other !== undefined) found.push([one, other]);
    }
    return found;
  }
}
