/** A creature's network: inputs at the left, outputs at the right, weights as lines. */

import { useMemo } from "preact/hooks";
import type { Link, Network } from "../decode/network";
import { number } from "../ui/format";
import { type PlacedNeuron, layoutOf } from "./networkLayout";
import { text } from "./text";
import "./creature.css";
import "./details.css";

const RADIUS = 13;
/** Bounds of the scale; a network that is too large scrolls. */
const [MAX_SCALE, MIN_SCALE] = [1.2, 0.5];

interface Props {
  network: Network;
  /** The node whose links stand out. */
  selected?: number | null;
  onSelect?: (id: number) => void;
}

export function NetworkGraph({ network, selected = null, onSelect }: Props) {
  const { width, height, placed } = useMemo(() => layoutOf(network), [network]);
  const largest = Math.max(1e-9, ...network.links.map(({ weight }) => Math.abs(weight)));
  const enabled = network.links.filter((link) => link.enabled).length;
  const summary = text.networkSummary(network.neurons.length, enabled);
  return (
    <figure class="network">
      <div class="scroll">
        <svg
          viewBox={`0 0 ${width} ${height}`}
          style={{ maxWidth: `${MAX_SCALE * width}px`, minWidth: `${MIN_SCALE * width}px` }}
          role={onSelect ? "group" : "img"}
          class={selected === null ? "" : "has-selection"}
          aria-label={text.networkLabel(summary)}
        >
          {network.links.map((link, i) => (
            <Wire key={i} {...{ link, placed, largest }} into={link.target === selected} />
          ))}
          {[...placed.values()].map((node) => (
            <Node key={node.neuron.id} {...{ ...node, onSelect }} selected={node.neuron.id === selected} />
          ))}
        </svg>
      </div>
      <figcaption class="row">
        <span class="key positive">{text.positive}</span>
        <span class="key negative">{text.negative}</span>
        <span class="key off">{text.disabled}</span>
        <span class="quiet">
          {summary}
          {text.widthMeans(number(largest, 2))}
        </span>
      </figcaption>
    </figure>
  );
}

interface WireProps {
  link: Link;
  placed: Map<number, PlacedNeuron>;
  largest: number;
  into: boolean;
}

function Wire({ link, placed, largest, into }: WireProps) {
  const [from, to] = [placed.get(link.source), placed.get(link.target)];
  if (!from || !to) return null;
  return (
    <path
      class={`wire ${link.weight < 0 ? "negative" : ""} ${link.enabled ? "" : "off"} ${into ? "into" : ""}`}
      d={pathOf(from, to)}
      stroke-width={0.75 + (4.5 * Math.abs(link.weight)) / largest}
    >
      <title>{text.weight(number(link.weight), link.enabled)}</title>
    </path>
  );
}

function pathOf(from: PlacedNeuron, to: PlacedNeuron): string {
  if (from === to) {
    const [side, top] = [2.2 * RADIUS, from.y - 4 * RADIUS];
    return `M${from.x},${from.y} C${from.x - side},${top} ${from.x + side},${top} ${to.x},${to.y}`;
  }
  // A wire that leads back or stays in its column bends to the left.
  const bend = to.x > from.x ? (to.x - from.x) / 2 : -4 * RADIUS;
  const [a, b] = [from.x + bend, to.x - Math.abs(bend)];
  return `M${from.x},${from.y} C${a},${from.y} ${b},${to.y} ${to.x},${to.y}`;
}

interface NodeProps extends PlacedNeuron, Pick<Props, "onSelect"> {
  selected: boolean;
}

function Node({ neuron, x, y, selected, onSelect }: NodeProps) {
  const select = () => onSelect?.(neuron.id);
  const name = neuron.label || text.node(neuron.id);
  const widget = onSelect && {
    tabIndex: 0,
    role: "button" as const,
    "aria-pressed": selected,
    "aria-label": text.showOutput(`${name} ${neuron.activation}`),
    onFocus: select,
    onClick: select,
    onPointerEnter: select,
  };
  const beside = neuron.role === "input" ? -1 : 1;
  return (
    <g
      class={`neuron ${neuron.role} ${selected ? "selected" : ""}`}
      transform={`translate(${x},${y})`}
      {...widget}
    >
      <title>{text.nodeAbout(name, neuron.activation, number(neuron.bias))}</title>
      <circle r={RADIUS} />
      {neuron.role !== "input" && <Curve activation={neuron.activation} />}
      {neuron.role !== "hidden" && (
        <text class="name" x={beside * (RADIUS + 6)} dy="0.32em" data-side={neuron.role}>
          {neuron.label}
        </text>
      )}{" "}
      {neuron.role !== "input" && (
        <text class="activation" y={RADIUS + 12}>
          {neuron.activation}
        </text>
      )}
    </g>
  );
}

const SHAPES: Record<string, (x: number) => number> = {
  identity: (x) => x,
  sigmoid: (x) => 2 / (1 + Math.exp(-4 * x)) - 1,
  tanh: (x) => Math.tanh(2.5 * x),
  relu: (x) => 1.6 * Math.max(0, x) - 0.8,
  sin: (x) => Math.sin(Math.PI * x),
  cos: (x) => Math.cos(Math.PI * x),
  gaussian: (x) => 1.8 * Math.exp(-4 * x * x) - 0.9,
  abs: (x) => 1.6 * Math.abs(x) - 0.8,
  square: (x) => 1.6 * x * x - 0.8,
};

/** The graph of a node's activation function, inside its circle. */
function Curve({ activation }: { activation: string }) {
  const shape = SHAPES[activation];
  if (!shape) return null;
  const points = Array.from({ length: 25 }, (_, i) => {
    const x = i / 12 - 1;
    return `${(7.5 * x).toFixed(1)},${(-6.5 * shape(x)).toFixed(1)}`;
  });
  return <polyline class="shape" points={points.join(" ")} />;
}
