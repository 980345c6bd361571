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
  const seconds = useSecondsEach(estimate, generations);
  const [typed, setTyped] = useState<string | null>(null);
  if (seconds === null || typeof generations !== "number") return null;
  const minutes = (generations * seconds) / 60;
  const change = (value: string) => {
    setTyped(value);
    const wanted = generationsIn(Number(value), seconds);
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

/** The seconds of a generation by the last estimate; null before there is one. */
function useSecondsEach(estimate: Estimate | null, generations: unknown): number | null {
  const [each, setEach] = useState<number | null>(null);
  useEffect(() => {
    // An answer belongs to the generations for which it was asked: the form has not changed since.
    if (estimate?.seconds && typeof generations === "number") setEach(estimate.seconds / generations);
  }, [estimate]);
  return each;
}

/** As many generations as fit into some minutes, at least one; null for what is no time. */
export function generationsIn(minutes: number, secondsEach: number): number | null {
  if (!Number.isFinite(minutes) || minutes <= 0) return null;
  return Math.max(1, Math.floor((60 * minutes) / secondsEach));
}

/** With two digits. */
export const shownMinutes = (minutes: number): string => String(Number(minutes.toPrecision(2)));
