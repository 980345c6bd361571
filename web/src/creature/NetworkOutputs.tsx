/** Outputs of a network, and of a selected node, along the body and over time. */

import { useCallback, useMemo, useState } from "preact/hooks";
import type { Spec } from "../api/types";
import type { Network, Neuron } from "../decode/network";
import { COLUMNS, type Activations, ROWS, activationsOf, inputsOf, phaseOf } from "../decode/activations";
import { capitalised, number } from "../ui/format";
import { Slider } from "../ui/Select";
import type { Playhead } from "../replay/clock";
import { DivergingLegend, HeatMap } from "./HeatMap";
import { text } from "./text";

interface Props {
  network: Network;
  selected: number | null;
  control: Spec;
  steps: number;
  playhead: Playhead;
  every: number | null;
}

export function NetworkOutputs(props: Props) {
  if (props.control.anatomy !== true) return <OutputMaps {...props} />;
  return (
    <div class="outputs">
      <h3>{text.outputs}</h3>
      <p class="quiet small">{text.outputsOfAnatomy}</p>
    </div>
  );
}

function OutputMaps({ network, selected, control, steps, playhead, every }: Props) {
  const [energy, setEnergy] = useState(0);
  const inputs = useMemo(() => inputsOf(control), [control]);
  const activations = useMemo(
    () => activationsOf(network, control, steps, energy),
    [network, control, steps, energy],
  );
  const outputs = network.neurons.filter(({ role }) => role === "output");
  const selectedNode = network.neurons.find(({ id, role }) => id === selected && role !== "output");
  const shared = { activations, inputs, playhead, every };
  return (
    <div class="outputs">
      <h3>{text.outputs}</h3>
      <p class="quiet small">
        {text.outputAxes(
          inputs.recurrent
            ? text.settledSteps(activations.from, activations.to)
            : inputs.timer === "linear"
              ? text.wholeLife
              : text.onePeriod(number(inputs.period)),
        )}
      </p>
      {inputs.senses && (
        <Slider
          {...{ title: text.sensedEnergy, min: 0, max: 2, step: 0.05 }}
          value={energy}
          onChange={setEnergy}
        >
          <output>{number(energy)}</output>
        </Slider>
      )}
      <div class="output-pictures">
        {outputs.map((neuron) => (
          <OutputMap key={neuron.id} {...{ neuron, ...shared }} selected={neuron.id === selected} />
        ))}
        {selectedNode && <OutputMap key="other" {...{ neuron: selectedNode, ...shared }} selected />}
      </div>
      <DivergingLegend title={text.tanhOutputs} end="1" />
    </div>
  );
}

interface OutputMapProps extends Pick<Props, "playhead" | "every"> {
  neuron: Neuron;
  activations: Activations;
  inputs: ReturnType<typeof inputsOf>;
  selected: boolean;
}

/** Outputs act through tanh, except growth, of which only the sign counts. */
const squashed = ({ role, label }: Neuron) => role === "output" && label !== "growth";

function OutputMap({ neuron, activations, inputs, playhead, every, selected }: OutputMapProps) {
  const raw = activations.values.get(neuron.id)!;
  const values = useMemo(() => (squashed(neuron) ? raw.map(Math.tanh) : raw), [neuron, raw]);
  const limit = squashed(neuron) ? 1 : values.reduce((top, value) => Math.max(top, Math.abs(value)), 0);
  const name = neuron.label || text.node(neuron.id);
  const { from, to } = activations;
  const positionOf = useCallback(
    (time: number) => phaseOf(time * (every ?? 0), { from, to }, inputs),
    [every, inputs, from, to],
  );
  const read = (column: number, row: number) => {
    const value = number(values[column * ROWS + row]);
    const step = Math.round(from + ((to - from) * column) / COLUMNS);
    return text.outputAt(value, Math.round((100 * row) / (ROWS - 1)), step);
  };
  const range = squashed(neuron) ? "" : text.upTo(number(limit, 2));
  return (
    <figure class={selected ? "selected" : ""}>
      <figcaption>{capitalised(name)}</figcaption>
      <HeatMap
        matrix={{ columns: COLUMNS, rows: ROWS, values }}
        label={text.outputOf(name)}
        about={`${neuron.activation}${range}`}
        {...{ limit, read, playhead, positionOf }}
      />
    </figure>
  );
}
