/** A layered network as a graph; its genes are one row of bias and weights per neuron. */

import type { Spec, Vector } from "../api/types";
import { decodeFloats } from "./floats";
import { type Link, type Network, type Neuron, labelOf } from "./network";

/** More links cannot be distinguished. */
const MAX_LINKS = 600;

/** Null without layers, or with too many links to draw. */
export function layeredOf({ encoding, control, values, inputs, outputs }: Vector): Network | null {
  if (encoding !== "weights" || !inputs || !outputs) return null;
  const sizes = [inputs.length, ...(control.hidden as number[]), outputs.length];
  const links = sizes.slice(1).reduce((sum, size, i) => sum + size * sizes[i]!, 0);
  return links > MAX_LINKS ? null : graph(sizes, decodeFloats(values), control, inputs, outputs);
}

function graph(sizes: number[], genes: Float32Array, control: Spec, inputs: string[], outputs: string[]) {
  const ids = numbersOf(sizes);
  const last = sizes.length - 1;
  const neurons = ids[0]!.map((id): Neuron => {
    return { id, role: "input", label: labelOf(inputs[id]!), activation: "identity", bias: 0 };
  });
  const links: Link[] = [];
  let used = 0;
  for (let layer = 1; layer <= last; layer++) {
    const role = layer === last ? "output" : "hidden";
    const activation = layer === last ? "identity" : String(control.activation);
    ids[layer]!.forEach((id, place) => {
      const row = [...genes.subarray(used, (used += sizes[layer - 1]! + 1))].map(
        (gene) => gene * Number(control.scale),
      );
      const label = role === "output" ? labelOf(outputs[place]!) : "";
      neurons.push({ id, role, label, activation, bias: row[0]! });
      ids[layer - 1]!.forEach((source, i) =>
        links.push({ source, target: id, weight: row[i + 1]!, enabled: true }),
      );
    });
  }
  return { neurons, links };
}

/** Inputs are numbered first, then outputs, as in NEAT. */
function numbersOf(sizes: number[]): number[][] {
  const last = sizes.length - 1;
  let next = sizes[0]! + sizes[last]!;
  return sizes.map((size, layer) => {
    const first = layer === 0 ? 0 : layer === last ? sizes[0]! : (next += size) - size;
    return Array.from({ length: size }, (_, i) => first + i);
  });
}
