/** A genome as a graph: nodes, and links with their weights. */

import type { Genes } from "../api/types";
import { decodeFloats } from "./floats";

export interface Neuron {
  id: number;
  role: "input" | "output" | "hidden";
  label: string;
  activation: string;
  bias: number;
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
  const names = [...inputs, ...outputs];
  const neurons = nodes.id.map((id, i) => ({
    id,
    role: roleOf(id, inputs.length, outputs.length),
    label: labelOf(names[id] ?? ""),
    activation: nodes.activation[i]!,
    bias: biases[i]!,
  }));
  return { neurons, links };
}

export const labelOf = (name: string) => name.replaceAll("_", " ");

function roleOf(id: number, inputs: number, outputs: number): Neuron["role"] {
  if (id < inputs) return "input";
  return id < inputs + outputs ? "output" : "hidden";
}
