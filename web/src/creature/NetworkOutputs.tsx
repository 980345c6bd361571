/** What a network computes: each output, and a node that is pointed at, over body and time. */

import { useCallback, useMemo, useState } from "preact/hooks";
import type { Spec } from "../api/types";
import type { Network, Neuron } from "../decode/network";
import { COLUMNS, type Activations, ROWS, activationsOf, shareOf, sampledTimes } from "../decode/activations";
import { number } from "../ui/format";
import type { Moment } from "../replay/moment";
import { HeatMap } from "./HeatMap";
import { DivergingLegend } from "./SpaceTime";

interface Props {
  network: Network;
  chosen: number | null;
  control: Spec;
  steps: number;
  moment: Moment;
  every: number | null;
}

export function NetworkOutputs({ network, chosen, control, steps, moment, every }: Props) {
  const [energy, setEnergy] = useState(0);
  const sight = useMemo(() => sampledTimes(control), [control]);
  const pictures = useMemo(
    () => activationsOf(network, control, steps, energy),
    [network, control, steps, energy],
  );
  const outputs = network.neurons.filter(({ role }) => role === "output");
  const other = network.neurons.find(({ id, role }) => id === chosen && role !== "output");
  const shared = { pictures, sight, moment, every };
  return (
    <div class="outputs">
      <h3>What it computes</h3>
      <p class="quiet small">
        {sight.recurrent
          ? `Across: steps ${pictures.from} to ${pictures.to}, when its memory has settled. `
          : sight.timer === "linear"
            ? "Across: its whole life. "
            : `Across: one period, ${number(sight.period)} steps. `}
        Up: along the body. Point at a node, or move to it with Tab, to see it too.
      </p>
      {sight.senses && (
        <label class="compact">
          Energy it senses
          <input
            type="range"
            min="0"
            max="2"
            step="0.05"
            value={energy}
            onInput={(event) => setEnergy(event.currentTarget.valueAsNumber)}
          />
          <output>{number(energy)}</output>
        </label>
      )}
      <div class="output-pictures">
        {outputs.map((neuron) => (
          <Picture key={neuron.id} {...{ neuron, ...shared }} chosen={neuron.id === chosen} />
        ))}
        {other && <Picture key="other" {...{ neuron: other, ...shared }} chosen />}
      </div>
      <DivergingLegend title="Outputs, after tanh" end="1" />
    </div>
  );
}

interface PictureProps extends Pick<Props, "moment" | "every"> {
  neuron: Neuron;
  pictures: Activations;
  sight: ReturnType<typeof sampledTimes>;
  chosen: boolean;
}

/** Outputs act through tanh; growth counts by its sign alone, and other nodes as they are. */
const squashed = ({ role, label }: Neuron) => role === "output" && label !== "growth";

function Picture({ neuron, pictures, sight, moment, every, chosen }: PictureProps) {
  const said = pictures.values.get(neuron.id)!;
  const values = useMemo(() => (squashed(neuron) ? said.map(Math.tanh) : said), [neuron, said]);
  const most = squashed(neuron) ? 1 : values.reduce((top, value) => Math.max(top, Math.abs(value)), 0);
  const name = neuron.label || `node ${neuron.id}`;
  const { from, to } = pictures;
  const place = useCallback(
    (time: number) => shareOf(time * (every ?? 0), { from, to }, sight),
    [every, sight, from, to],
  );
  const read = (column: number, row: number) => {
    const value = number(values[column * ROWS + row]);
    const step = Math.round(from + ((to - from) * column) / COLUMNS);
    return `${value} at ${Math.round((100 * row) / (ROWS - 1))} % of the body, step ${step}`;
  };
  const range = squashed(neuron) ? "" : `, up to ±${number(most, 2)}`;
  return (
    <figure class={chosen ? "chosen" : ""}>
      <figcaption>{name.charAt(0).toUpperCase() + name.slice(1)}</figcaption>
      <HeatMap
        cells={{ columns: COLUMNS, rows: ROWS, values }}
        label={`What ${name} says over time and along the body`}
        about={`${neuron.activation}${range}`}
        {...{ most, read, moment, place }}
      />
    </figure>
  );
}
