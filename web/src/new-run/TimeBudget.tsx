/** The length of a run in minutes: as many generations as fit, by the speed of earlier runs. */

import { useEffect, useState } from "preact/hooks";
import type { Estimate } from "../api/types";
import { valueAt } from "./form/document";
import type { FormState } from "./form/Entry";
import { text } from "./text";

const GENERATIONS = "search.generations";
const ID = "time-budget";

interface Props {
  estimate: Estimate | null;
  state: FormState;
}

export function TimeBudget({ estimate, state }: Props) {
  const generations = valueAt(state.document, GENERATIONS);
  const pace = usePace(estimate, generations);
  const [typed, setTyped] = useState<string | null>(null);
  if (pace === null || typeof generations !== "number") return null;
  const minutes = (pace.startup + generations * pace.each) / 60;
  const change = (value: string) => {
    setTyped(value);
    const wanted = generationsIn(Number(value), pace);
    if (wanted !== null) state.change(GENERATIONS, wanted);
  };
  return (
    <div class="entry">
      <span class="entry-name">
        <label for={ID}>{text.minutes}</label>
      </span>
      <input
        {...{ id: ID, type: "number", min: 0, step: "any" }}
        value={typed ?? shownMinutes(minutes)}
        aria-describedby={`${ID}-about`}
        onInput={(event) => change(event.currentTarget.value)}
        onBlur={() => setTyped(null)}
      />
      <div id={`${ID}-about`} class="about">
        <p class="help">{text.minutesAbout}</p>
      </div>
    </div>
  );
}

/** Seconds of the start, in which programs are compiled, and of each generation. */
export interface Pace {
  startup: number;
  each: number;
}

/** The pace by the last estimate; null before there is one. */
function usePace(estimate: Estimate | null, generations: unknown): Pace | null {
  const [pace, setPace] = useState<Pace | null>(null);
  useEffect(() => {
    // An answer belongs to the generations for which it was asked: the form has not changed since.
    if (estimate && typeof generations === "number") setPace((old) => paceOf(estimate, generations) ?? old);
  }, [estimate]);
  return pace;
}

export function paceOf(
  { seconds, cell_steps, speed }: Pick<Estimate, "seconds" | "cell_steps" | "speed">,
  generations: number,
): Pace | null {
  if (!seconds || !speed) return null;
  const computing = cell_steps / speed.cell_steps_per_second;
  return { startup: Math.max(0, seconds - computing), each: computing / generations };
}

/** As many generations as fit into some minutes, at least one; null for what is no time. */
export function generationsIn(minutes: number, { startup, each }: Pace): number | null {
  if (!Number.isFinite(minutes) || minutes <= 0) return null;
  return Math.max(1, Math.floor((60 * minutes - startup) / each));
}

/** With two digits. */
export const shownMinutes = (minutes: number): string => String(Number(minutes.toPrecision(2)));
