/** What a network computes, from its genes; as `genomes/cppn.py` and `recurrent.py` have it. */

import type { Link, Network, Neuron } from "./network";

/** Values are kept within this, as in the engine. */
const BOUND = 1e6;

const ACTIVATIONS: Record<string, (z: number) => number> = {
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

/** By node, a value at each point. */
export type Values = Map<number, Float64Array>;

/** All nodes of a feed-forward network; `inputs` in the order of the input nodes. */
export function evaluate(network: Network, inputs: Float64Array[]): Values {
  const arriving = arrivingAt(network);
  const values: Values = new Map();
  const visit = (neuron: Neuron) => {
    const place = network.neurons.indexOf(neuron);
    const links = arriving.get(neuron.id) ?? [];
    values.set(
      neuron.id,
      neuron.role === "input" ? inputs[place]! : computed(neuron, links, values, inputs[0]!.length),
    );
  };
  inOrder(network).forEach(visit);
  return values;
}

/**
 * All nodes of a network with cycles, one step later: every node reads what the others said in
 * the step before, and the new inputs.
 */
export function advance(network: Network, before: Values, inputs: Float64Array[]): Values {
  const arriving = arrivingAt(network);
  const points = inputs[0]!.length;
  const seen: Values = new Map(
    network.neurons.map(({ id, role }, i) => [
      id,
      role === "input" ? inputs[i]! : (before.get(id) ?? new Float64Array(points)),
    ]),
  );
  return new Map(
    network.neurons.map((neuron) => {
      const { id, role } = neuron;
      const value = role === "input" ? seen.get(id)! : computed(neuron, arriving.get(id) ?? [], seen, points);
      return [id, value];
    }),
  );
}

function computed({ activation, bias }: Neuron, links: Link[], values: Values, points: number) {
  const found = new Float64Array(points).fill(bias);
  for (const { source, weight } of links) {
    const from = values.get(source)!;
    for (let i = 0; i < points; i++) found[i]! += weight * from[i]!;
  }
  const apply = ACTIVATIONS[activation]!;
  return found.map((z) => Math.min(BOUND, Math.max(-BOUND, apply(z))));
}

const known = new WeakMap<Network, Map<number, Link[]>>();

/** The links in use that lead to each node. */
function arrivingAt(network: Network): Map<number, Link[]> {
  let found = known.get(network);
  if (found) return found;
  found = new Map<number, Link[]>(network.neurons.map(({ id }) => [id, []]));
  for (const link of network.links) if (link.enabled) found.get(link.target)?.push(link);
  known.set(network, found);
  return found;
}

/** Neurons so that whatever one reads comes before it. */
function inOrder(network: Network): Neuron[] {
  const byId = new Map(network.neurons.map((neuron) => [neuron.id, neuron]));
  const arriving = arrivingAt(network);
  const order = new Set<Neuron>();
  const waiting = [...network.neurons].reverse();
  while (waiting.length > 0) {
    const neuron = waiting.at(-1)!;
    const missing = (arriving.get(neuron.id) ?? [])
      .map(({ source }) => byId.get(source)!)
      .filter((source) => !order.has(source));
    if (order.has(neuron) || missing.length === 0) order.add(waiting.pop()!);
    else waiting.push(...missing);
  }
  return [...order];
}
