/** Where the nodes of a network stand: columns by depth, spread by forces within them. */

import {
  type SimulationLinkDatum,
  type SimulationNodeDatum,
  forceCollide,
  forceLink,
  forceSimulation,
  forceX,
  forceY,
} from "d3-force";
import type { Network, Neuron } from "../decode/network";

export interface Spot extends SimulationNodeDatum {
  neuron: Neuron;
  x: number;
  y: number;
}

export interface Layout {
  width: number;
  height: number;
  spots: Map<number, Spot>;
}

const WIDEST = 130;
const NARROWEST = 84;
const ROW = 58;
const MARGIN = { x: 92, y: 36 };
const TICKS = 240;

export function layoutOf({ neurons, links, depth }: Network): Layout {
  const pitch = Math.max(NARROWEST, Math.min(WIDEST, (3.5 * WIDEST) / depth));
  const columns = Array.from({ length: depth + 1 }, (_, layer) =>
    neurons.filter((neuron) => neuron.depth === layer),
  );
  const height = Math.max(2 * ROW, ROW * Math.max(...columns.map((column) => column.length)));
  const spots = columns.flatMap((column) =>
    column.map((neuron, i): Spot => {
      const y = (height * (i + 0.5)) / column.length;
      // Inputs and outputs keep their order; what is between finds its own.
      const fixed = neuron.role === "hidden" ? null : y;
      return { neuron, x: pitch * neuron.depth, y, fx: pitch * neuron.depth, fy: fixed };
    }),
  );
  const byId = new Map(spots.map((spot) => [spot.neuron.id, spot]));
  const springs: SimulationLinkDatum<Spot>[] = links
    .filter(({ source, target }) => byId.has(source) && byId.has(target))
    .map(({ source, target }) => ({ source: byId.get(source)!, target: byId.get(target)! }));
  forceSimulation(spots)
    .force("link", forceLink(springs).distance(pitch).strength(0.05))
    .force(
      "column",
      forceX<Spot>((spot) => pitch * spot.neuron.depth),
    )
    .force("middle", forceY<Spot>(height / 2).strength(0.02))
    .force("apart", forceCollide(ROW / 2))
    .stop()
    .tick(TICKS);
  for (const spot of spots) {
    spot.x += MARGIN.x;
    spot.y = Math.min(height, Math.max(0, spot.y)) + MARGIN.y;
  }
  return { width: pitch * depth + 2 * MARGIN.x, height: height + 2 * MARGIN.y, spots: byId };
}
