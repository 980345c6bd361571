/** The values of every node of a CPPN or layered controller, along the body and over time; the engine turns outputs into rest angles. */

import type { Spec } from "../api/types";
import { type Values, advance, evaluate, incomingLinks } from "./evaluate";
import type { Network } from "./network";

/** Places along the body, and times, of a picture. */
export const [ROWS, COLUMNS] = [48, 96];
/** A recurrent network is simulated for at most this number of steps. */
const MAX_STEPS = 5000;

export interface Activations {
  /** (column, row) for each node. */
  values: Values;
  /** The steps of the first column and of the one after the last. */
  from: number;
  to: number;
}

type Inputs = ReturnType<typeof inputsOf>;

export const inputsOf = (control: Spec) => ({
  timer: String(control.timer ?? "sine-cosine"),
  period: Number(control.period),
  position: String(control.position ?? "signed"),
  waves: control.timer === "linear" ? null : ((control.wave_number ?? null) as number | null),
  senses: control.sense_energy === true,
  recurrent: control.recurrent === true,
});

/** One period of the timer, or the whole task for a linear timer; `energy` is sensed everywhere. */
export function activationsOf(network: Network, control: Spec, steps: number, energy = 0): Activations {
  const inputs = inputsOf(control);
  return (inputs.recurrent ? recurrentValues : feedForwardValues)(network, inputs, steps, energy);
}

/** The position of a step in the pictures, from 0 to 1; for a periodic timer, its phase. */
export function phaseOf(
  step: number,
  { from, to }: Pick<Activations, "from" | "to">,
  inputs: Inputs,
): number {
  const since = step - from;
  const { period } = inputs;
  const along = inputs.timer === "linear" ? since : ((since % period) + period) % period;
  return Math.min(1, Math.max(0, along / (to - from)));
}

function feedForwardValues(network: Network, inputs: Inputs, steps: number, energy: number): Activations {
  const to = inputs.timer === "linear" ? steps : inputs.period;
  const columns = Array.from({ length: COLUMNS }, (_, i) =>
    inputsAt(inputs, (to * i) / COLUMNS, steps, energy),
  );
  const rows = columns[0]!.map((_, k) => {
    const row = new Float64Array(COLUMNS * ROWS);
    columns.forEach((column, i) => row.set(column[k]!, i * ROWS));
    return row;
  });
  return { values: evaluate(network, rows), from: 0, to };
}

/** The last period, when the memory has settled. */
function recurrentValues(network: Network, inputs: Inputs, steps: number, energy: number): Activations {
  const to = Math.min(steps, MAX_STEPS);
  const from = inputs.timer === "linear" ? 0 : Math.max(0, to - Math.round(inputs.period));
  const values: Values = new Map(network.neurons.map(({ id }) => [id, new Float64Array(COLUMNS * ROWS)]));
  const stepOf = (column: number) => from + Math.floor(((to - from) * column) / COLUMNS);
  const incoming = incomingLinks(network);
  let now: Values = new Map();
  let column = 0;
  for (let step = 0; step < to; step++) {
    now = advance(network, incoming, now, inputsAt(inputs, step, steps, energy));
    for (; column < COLUMNS && stepOf(column) === step; column++) {
      for (const [id, row] of now) values.get(id)!.set(row, column * ROWS);
    }
  }
  return { values, from, to };
}

/** The inputs of a network along the body at one time. */
function inputsAt(inputs: Inputs, step: number, steps: number, energy: number): Float64Array[] {
  const { timer, period, position, waves, senses } = inputs;
  const along = (value: (share: number) => number) =>
    Float64Array.from({ length: ROWS }, (_, i) => value(i / (ROWS - 1)));
  const phase = (2 * Math.PI * step) / period;
  const clock =
    timer === "linear"
      ? [along(() => step / steps)]
      : [along(() => Math.sin(phase)), along(() => Math.cos(phase))];
  const lag = (share: number) => phase - 2 * Math.PI * waves! * share;
  return [
    along((share) => (position === "unit" ? share : 2 * share - 1)),
    ...clock,
    ...(waves === null
      ? []
      : [along((share) => Math.sin(lag(share))), along((share) => Math.cos(lag(share)))]),
    ...(senses ? [along(() => energy)] : []),
  ];
}
