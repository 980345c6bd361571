/**
 * The values of every node of a CPPN or layered controller, along the body and over time. Networks are
 * evaluated as `genomes/cppn.py` and `recurrent.py` do; the engine turns outputs into rest angles.
 */

import type { Spec } from "../api/types";
import type { Link, Network, Neuron } from "./network";

/** Places along the body, and times, of a picture. */
export const [ROWS, COLUMNS] = [48, 96];
/** A recurrent network is simulated for at most this number of steps. */
const MAX_STEPS = 5000;

export interface Activations {
  /** (column, row) for each node. */
  values: Values;
  /** The steps of the first column and of the one after the last. */
  from: number;
  to: number;
}

type Inputs = ReturnType<typeof inputsOf>;

export const inputsOf = (control: Spec) => ({
  timer: String(control.timer ?? "sine-cosine"),
  period: Number(control.period),
  position: String(control.position ?? "signed"),
  waves: control.timer === "linear" ? null : ((control.wave_number ?? null) as number | null),
  senses: control.sense_energy === true,
  recurrent: control.recurrent === true,
});

/** One period of the timer, or the whole task for a linear timer; `energy` is sensed everywhere. */
export function activationsOf(network: Network, control: Spec, steps: number, energy = 0): Activations {
  const inputs = inputsOf(control);
  return (inputs.recurrent ? recurrentValues : feedForwardValues)(network, inputs, steps, energy);
}

/** The position of a step in the pictures, from 0 to 1; for a periodic timer, its phase. */
export function phaseOf(
  step: number,
  { from, to }: Pick<Activations, "from" | "to">,
  inputs: Inputs,
): number {
  const since = step - from;
  const { period } = inputs;
  const along = inputs.timer === "linear" ? since : ((since % period) + period) % period;
  return Math.min(1, Math.max(0, along / (to - from)));
}

function feedForwardValues(network: Network, inputs: Inputs, steps: number, energy: number): Activations {
  const to = inputs.timer === "linear" ? steps : inputs.period;
  const columns = Array.from({ length: COLUMNS }, (_, i) =>
    inputsAt(inputs, (to * i) / COLUMNS, steps, energy),
  );
  const rows = columns[0]!.map((_, k) => {
    const row = new Float64Array(COLUMNS * ROWS);
    columns.forEach((column, i) => row.set(column[k]!, i * ROWS));
    return row;
  });
  return { values: evaluate(network, rows), from: 0, to };
}

/** The last period, when the memory has settled. */
function recurrentValues(network: Network, inputs: Inputs, steps: number, energy: number): Activations {
  const to = Math.min(steps, MAX_STEPS);
  const from = inputs.timer === "linear" ? 0 : Math.max(0, to - Math.round(inputs.period));
  const values: Values = new Map(network.neurons.map(({ id }) => [id, new Float64Array(COLUMNS * ROWS)]));
  const stepOf = (column: number) => from + Math.floor(((to - from) * column) / COLUMNS);
  const incoming = incomingLinks(network);
  let now: Values = new Map();
  let column = 0;
  for (let step = 0; step < to; step++) {
    now = advance(network, incoming, now, inputsAt(inputs, step, steps, energy));
    for (; column < COLUMNS && stepOf(column) === step; column++) {
      for (const [id, row] of now) values.get(id)!.set(row, column * ROWS);
    }
  }
  return { values, from, to };
}

/** The inputs of a network along the body at one time. */
function inputsAt(inputs: Inputs, step: number, steps: number, energy: number): Float64Array[] {
  const { timer, period, position, waves, senses } = inputs;
  const along = (value: (share: number) => number) =>
    Float64Array.from({ length: ROWS }, (_, i) => value(i / (ROWS - 1)));
  const phase = (2 * Math.PI * step) / period;
  const clock =
    timer === "linear"
      ? [along(() => step / steps)]
      : [along(() => Math.sin(phase)), along(() => Math.cos(phase))];
  const lag = (share: number) => phase - 2 * Math.PI * waves! * share;
  return [
    along((share) => (position === "unit" ? share : 2 * share - 1)),
    ...clock,
    ...(waves === null
      ? []
      : [along((share) => Math.sin(lag(share))), along((share) => Math.cos(lag(share)))]),
    ...(senses ? [along(() => energy)] : []),
  ];
}

/** The engine clips values to this bound too. */
const BOUND = 1e6;

export const ACTIVATIONS: Record<string, (z: number) => number> = {
  identity: (z) => z,
  sigmoid: (z) => 1 / (1 + Math.exp(-z)),
  tanh: Math.tanh,
  relu: (z) => Math.max(z, 0),
  sin: Math.sin,
  cos: Math.cos,
  gaussian: (z) => Math.exp(-z * z),
  abs: Math.abs,
  square: (z) => z * z,
};

/** Values of each node at each point. */
type Values = Map<number, Float64Array>;

/** All nodes of a feed-forward network; `inputs` in the order of the input nodes. */
function evaluate(network: Network, inputs: Float64Array[]): Values {
  const incoming = incomingLinks(network);
  const values: Values = new Map(
    network.neurons.flatMap(({ id, role }, i) => (role === "input" ? [[id, inputs[i]!]] : [])),
  );
  for (const neuron of topologicalOrder(network, incoming)) {
    if (neuron.role === "input") continue;
    values.set(neuron.id, activate(neuron, incoming.get(neuron.id)!, values, inputs[0]!.length));
  }
  return values;
}

/** All nodes of a recurrent network one step later; each reads the values of the step before. */
function advance(network: Network, incoming: Incoming, before: Values, inputs: Float64Array[]): Values {
  const points = inputs[0]!.length;
  const known: Values = new Map(
    network.neurons.map(({ id, role }, i) => [
      id,
      role === "input" ? inputs[i]! : (before.get(id) ?? new Float64Array(points)),
    ]),
  );
  return new Map(
    network.neurons.map((neuron) => {
      const { id, role } = neuron;
      return [id, role === "input" ? known.get(id)! : activate(neuron, incoming.get(id)!, known, points)];
    }),
  );
}

function activate({ activation, bias }: Neuron, links: Link[], values: Values, points: number) {
  const sums = new Float64Array(points).fill(bias);
  for (const { source, weight } of links) {
    const from = values.get(source)!;
    for (let i = 0; i < points; i++) sums[i]! += weight * from[i]!;
  }
  const apply = ACTIVATIONS[activation]!;
  return sums.map((z) => Math.min(BOUND, Math.max(-BOUND, apply(z))));
}

type Incoming = Map<number, Link[]>;

/** The enabled links into each node. */
function incomingLinks(network: Network): Incoming {
  const incoming: Incoming = new Map(network.neurons.map(({ id }) => [id, []]));
  for (const link of network.links) if (link.enabled) incoming.get(link.target)?.push(link);
  return incoming;
}

/** The neurons, sources before targets. */
function topologicalOrder({ neurons }: Network, incoming: Incoming): Set<Neuron> {
  const byId = new Map(neurons.map((neuron) => [neuron.id, neuron]));
  const order = new Set<Neuron>();
  const stack = [...neurons].reverse();
  while (stack.length > 0) {
    const neuron = stack.at(-1)!;
    const missing = incoming
      .get(neuron.id)!
      .map(({ source }) => byId.get(source)!)
      .filter((source) => !order.has(source));
    if (order.has(neuron) || missing.length === 0) order.add(stack.pop()!);
    else stack.push(...missing);
  }
  return order;
}
