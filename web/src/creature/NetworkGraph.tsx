/** A creature's network: inputs at the left, outputs at the right, weights as lines. */

import type { NetworkPositions } from "../api/types";
import { ACTIVATIONS } from "../decode/activations";
import type { Link, Network, Neuron } from "../decode/network";
import { number } from "../ui/format";
import { text } from "./text";
import "./creature.css";
import "./details.css";

const RADIUS = 13;
const REACH = 4 * RADIUS;
const ROW = 58;
/** Distances of columns; those of a deep network are close. */
const [MIN_PITCH, MAX_PITCH] = [84, 130];
const MARGIN = { x: 112, y: 50 };
/** Bounds of the scale; a network that is too large scrolls. */
const [MAX_SCALE, MIN_SCALE] = [1.2, 0.5];

interface Props {
  network: Network;
  positions: NetworkPositions;
  /** The node whose links stand out. */
  selected?: number | null;
  onSelect?: (id: number) => void;
}

type Point = [number, number];

export function NetworkGraph({ network, positions, selected = null, onSelect }: Props) {
  const pitch = Math.max(MIN_PITCH, Math.min(MAX_PITCH, (3.5 * MAX_PITCH) / positions.width));
  const width = pitch * positions.width + 2 * MARGIN.x;
  const height = ROW * positions.height + 2 * MARGIN.y;
  const drawn = ({ x, y }: NetworkPositions["nodes"][string]): Point => [
    pitch * x + MARGIN.x,
    ROW * y + MARGIN.y,
  ];
  const at = (id: number) => positions.nodes[id]!;
  const wayOf = ({ source, target }: Link) =>
    [at(source), ...(positions.passages[`${source}-${target}`] ?? []), at(target)].map(drawn);
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
            <Wire key={i} {...{ link, largest }} way={wayOf(link)} into={link.target === selected} />
          ))}
          {network.neurons.map((neuron) => (
            <Node key={neuron.id} {...{ neuron, onSelect, selected }} at={drawn(at(neuron.id))} />
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
  /** Points from the source to the target. */
  way: Point[];
  largest: number;
  into: boolean;
}

function Wire({ link, way, largest, into }: WireProps) {
  return (
    <path
      class={`wire ${link.weight < 0 ? "negative" : ""} ${link.enabled ? "" : "off"} ${into ? "into" : ""}`}
      d={pathOf(way)}
      stroke-width={0.75 + (4.5 * Math.abs(link.weight)) / largest}
    >
      <title>{text.weight(number(link.weight), link.enabled)}</title>
    </path>
  );
}

/** A curve level at each point; within a column it bends to the left, back or in a loop it rises. */
function pathOf([first, ...rest]: Point[]): string {
  let [x, y] = first!;
  const curves = rest.map(([toX, toY]) => {
    const within = toX === x && toY !== y;
    const [out, lift] = toX > x ? [(toX - x) / 2, 0] : within ? [-REACH, 0] : [REACH, REACH];
    const curve = `C${x + out},${y - lift} ${toX - Math.abs(out)},${toY - lift} ${toX},${toY}`;
    [x, y] = [toX, toY];
    return curve;
  });
  return `M${first} ${curves.join(" ")}`;
}

interface NodeProps extends Pick<Props, "selected" | "onSelect"> {
  neuron: Neuron;
  at: Point;
}

function Node({ neuron, at, onSelect, ...graph }: NodeProps) {
  const selected = neuron.id === graph.selected;
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
      transform={`translate(${at})`}
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

/** Half the width and half the height of a graph, in pixels. */
const [HALF_WIDTH, HALF_HEIGHT] = [7.5, 5.8];

/** The graph of a node's activation function from −π to π, inside its circle. */
function Curve({ activation }: { activation: string }) {
  const apply = ACTIVATIONS[activation];
  if (!apply) return null;
  const places = Array.from({ length: 25 }, (_, i) => i / 12 - 1);
  const values = places.map((place) => apply(Math.PI * place));
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const points = places.map((place, i) => {
    const up = (2 * (values[i]! - low)) / (high - low) - 1;
    return `${(HALF_WIDTH * place).toFixed(1)},${(-HALF_HEIGHT * up).toFixed(1)}`;
  });
  return <polyline class="shape" points={points.join(" ")} />;
}
