/** Layout of a network: columns by depth, ordered by the mean position of connected nodes. */

import type { Network, Neuron } from "../decode/network";

export interface PlacedNeuron {
  neuron: Neuron;
  x: number;
  y: number;
}

const [MIN_PITCH, MAX_PITCH] = [84, 130];
const ROW = 58;
const MARGIN = { x: 92, y: 36 };
const SWEEPS = 12;

export function layoutOf({ neurons, links, depth }: Network) {
  const pitch = Math.max(MIN_PITCH, Math.min(MAX_PITCH, (3.5 * MAX_PITCH) / depth));
  const layers = Array.from({ length: depth + 1 }, (_, layer) =>
    neurons.filter((one) => one.depth === layer),
  );
  const height = ROW * Math.max(2, ...layers.map((layer) => layer.length));
  const columns = layers.map((layer) =>
    layer.map((neuron, i): PlacedNeuron => ({
      ...{ neuron, x: pitch * neuron.depth + MARGIN.x },
      y: (height * (i + 0.5)) / layer.length + MARGIN.y,
    })),
  );
  const placed = new Map(columns.flat().map((node) => [node.neuron.id, node]));
  const connected = new Map<PlacedNeuron, PlacedNeuron[]>([...placed.values()].map((node) => [node, []]));
  for (const { source, target } of links) {
    const [from, to] = [placed.get(source), placed.get(target)];
    if (!from || !to || from === to) continue;
    connected.get(from)!.push(to);
    connected.get(to)!.push(from);
  }
  // Inputs and outputs keep their order.
  const free = columns.filter((column) => column.every(({ neuron }) => neuron.role === "hidden"));
  for (let sweep = 0; sweep < SWEEPS; sweep++) {
    for (const column of free) arrange(column, connected, height);
  }
  return { width: pitch * depth + 2 * MARGIN.x, height: height + 2 * MARGIN.y, placed };
}

/** Move nodes to the mean of their neighbours, then apart within the height. */
function arrange(column: PlacedNeuron[], connected: Map<PlacedNeuron, PlacedNeuron[]>, height: number): void {
  for (const node of column) {
    const near = connected.get(node)!;
    if (near.length > 0) node.y = near.reduce((sum, { y }) => sum + y, 0) / near.length;
  }
  column.sort((a, b) => a.y - b.y);
  let limit = MARGIN.y + ROW / 2;
  for (const node of column) limit = (node.y = Math.max(node.y, limit)) + ROW;
  limit = MARGIN.y + height - ROW / 2;
  for (const node of column.toReversed()) limit = (node.y = Math.min(node.y, limit)) - ROW;
}
