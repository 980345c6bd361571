/** What every node of a controller's network says along the body and over time. */

import type { Spec } from "../api/types";
import { type Values, advance, evaluate } from "./evaluate";
import type { Network } from "./network";

/** Places along the body, and moments, of a picture. */
export const [ROWS, COLUMNS] = [48, 96];
/** A network with memory is followed for at most so many steps. */
const LONGEST = 5000;

export interface Activations {
  /** (column, row) for each node. */
  values: Map<number, Float64Array>;
  /** Steps at which the first column and the one after the last would stand. */
  from: number;
  to: number;
}

interface Sight {
  timer: string;
  period: number;
  position: string;
  senses: boolean;
  recurrent: boolean;
}

export function sampledTimes(control: Spec): Sight {
  return {
    timer: String(control.timer ?? "sine-cosine"),
    period: Number(control.period),
    position: String(control.position ?? "signed"),
    senses: control.sense_energy === true,
    recurrent: control.recurrent === true,
  };
}

/** One period of the timer, or a whole life where it does not repeat; `energy` is felt everywhere. */
export function activationsOf(network: Network, control: Spec, steps: number, energy = 0): Activations {
  const sight = sampledTimes(control);
  return sight.recurrent ? remembered(network, sight, steps, energy) : atOnce(network, sight, steps, energy);
}

/** Where in the pictures a step of the life stands, from 0 to 1; where a timer repeats, its phase. */
export function shareOf(step: number, { from, to }: Pick<Activations, "from" | "to">, sight: Sight): number {
  const since = step - from;
  const { period } = sight;
  const along = sight.timer === "linear" ? since : ((since % period) + period) % period;
  return Math.min(1, Math.max(0, along / (to - from)));
}

function atOnce(network: Network, sight: Sight, steps: number, energy: number): Activations {
  const to = sight.timer === "linear" ? steps : sight.period;
  const places = placesOf(sight);
  const points = COLUMNS * ROWS;
  const position = Float64Array.from({ length: points }, (_, i) => places[i % ROWS]!);
  const clock = Array.from({ length: COLUMNS }, (_, i) => clockAt(sight, (to * i) / COLUMNS, steps));
  const timers = clock[0]!.map((_, k) =>
    Float64Array.from({ length: points }, (_, i) => clock[Math.floor(i / ROWS)]![k]!),
  );
  const felt = sight.senses ? [new Float64Array(points).fill(energy)] : [];
  return { values: evaluate(network, [position, ...timers, ...felt]), from: 0, to };
}

/** The last period of a life: a memory has settled by then as far as it will. */
function remembered(network: Network, sight: Sight, steps: number, energy: number): Activations {
  const to = Math.min(steps, LONGEST);
  const from = sight.timer === "linear" ? 0 : Math.max(0, to - Math.round(sight.period));
  const places = placesOf(sight);
  const values = new Map(network.neurons.map(({ id }) => [id, new Float64Array(COLUMNS * ROWS)]));
  const wanted = Array.from({ length: COLUMNS }, (_, i) => from + Math.floor(((to - from) * i) / COLUMNS));
  let said: Values = new Map();
  let column = 0;
  for (let step = 0; step < to; step++) {
    const clock = clockAt(sight, step, steps).map((value) => new Float64Array(ROWS).fill(value));
    const felt = sight.senses ? [new Float64Array(ROWS).fill(energy)] : [];
    said = advance(network, said, [places, ...clock, ...felt]);
    for (; column < COLUMNS && wanted[column] === step; column++) {
      for (const [id, row] of said) values.get(id)!.set(row, column * ROWS);
    }
  }
  return { values, from, to };
}

function placesOf({ position }: Sight): Float64Array {
  return Float64Array.from({ length: ROWS }, (_, i) => {
    const share = i / (ROWS - 1);
    return position === "unit" ? share : 2 * share - 1;
  });
}

function clockAt({ timer, period }: Sight, step: number, steps: number): number[] {
  if (timer === "linear") return [step / steps];
  const phase = (2 * Math.PI * step) / period;
  return [Math.sin(phase), Math.cos(phase)];
}
