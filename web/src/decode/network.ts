/** A genome as a graph: nodes with their depth, links with their weights. */

import type { Genes } from "../api/types";
import { decodeFloats } from "./floats";

export interface Neuron {
  id: number;
  role: "input" | "output" | "hidden";
  label: string;
  activation: string;
  bias: number;
  depth: number;
}

export interface Link {
  source: number;
  target: number;
  weight: number;
  enabled: boolean;
}

export interface Network {
  neurons: Neuron[];
  links: Link[];
  depth: number;
}

export function networkOf(genome: Genes): Network {
  const { nodes, connections, inputs, outputs } = genome;
  const biases = decodeFloats(nodes.bias);
  const weights = decodeFloats(connections.weight);
  const links = connections.source.map((source, i) => ({
    source,
    target: connections.target[i]!,
    weight: weights[i]!,
    enabled: connections.enabled[i]!,
  }));
  const depths = depthsOf(nodes.id, forwardOf(nodes.id, links), inputs.length, outputs.length);
  const names = [...inputs, ...outputs];
  const neurons = nodes.id.map((id, i) => ({
    id,
    role: roleOf(id, inputs.length, outputs.length),
    label: labelOf(names[id] ?? ""),
    activation: nodes.activation[i]!,
    bias: biases[i]!,
    depth: depths.get(id)!,
  }));
  return { neurons, links, depth: Math.max(...depths.values()) };
}

export const labelOf = (name: string) => name.replaceAll("_", " ");

function roleOf(id: number, inputs: number, outputs: number): Neuron["role"] {
  if (id < inputs) return "input";
  return id < inputs + outputs ? "output" : "hidden";
}

/** The links without those that close a cycle. */
function forwardOf(ids: number[], links: Link[]): Link[] {
  const leaving = new Map<number, Link[]>(ids.map((id) => [id, []]));
  for (const link of links) leaving.get(link.source)?.push(link);
  const entered = new Set<number>();
  const done = new Set<number>();
  const back = new Set<Link>();
  for (const start of ids) {
    const path = entered.has(start) ? [] : [start];
    while (path.length > 0) {
      const here = path.at(-1)!;
      entered.add(here);
      const link = leaving.get(here)?.pop();
      if (!link) {
        done.add(here);
        path.pop();
      } else if (!entered.has(link.target)) path.push(link.target);
      else if (!done.has(link.target)) back.add(link);
    }
  }
  return links.filter((link) => !back.has(link));
}

/** The longest path from an input to each node; outputs share the last layer. */
function depthsOf(ids: number[], links: Link[], inputs: number, outputs: number) {
  const depths = new Map(ids.map((id) => [id, id < inputs ? 0 : 1]));
  for (let round = 0; round < ids.length; round++) {
    let changed = false;
    for (const { source, target } of links) {
      const needed = (depths.get(source) ?? 0) + 1;
      if (target >= inputs && needed > (depths.get(target) ?? Infinity)) {
        depths.set(target, needed);
        changed = true;
      }
    }
    if (!changed) break;
  }
  const last = Math.max(1, ...depths.values());
  for (let id = inputs; id < inputs + outputs; id++) if (depths.has(id)) depths.set(id, last);
  return depths;
}
