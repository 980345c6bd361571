/** Evaluate a network from its genes, as `genomes/cppn.py` and `recurrent.py` do. */

import type { Link, Network, Neuron } from "./network";

/** The engine clips values to this bound too. */
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

/** Values of each node at each point. */
export type Values = Map<number, Float64Array>;

/** All nodes of a feed-forward network; `inputs` in the order of the input nodes. */
export function evaluate(network: Network, inputs: Float64Array[]): Values {
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
export function advance(
  network: Network,
  incoming: Incoming,
  before: Values,
  inputs: Float64Array[],
): Values {
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
export function incomingLinks(network: Network): Incoming {
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
