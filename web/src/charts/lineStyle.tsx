/** Colour and dash of the lines of several runs or cases in one plot. */

import "./lineStyle.css";

/** More lines cannot be distinguished. */
export const MAX_LINES = 8;
/** The most runs: beyond `MAX_LINES`, runs that differ in the seed alone share a line style. */
export const MAX_RUNS = 40;

const SOLID_LINES = 4;

export const colourOf = (index: number) => `--series-${1 + (index % MAX_LINES)}`;
export const dashOf = (index: number) => (index >= SOLID_LINES ? [7, 4] : undefined);

/** A sample of a line, for legends and tables. */
export function LineSample({ index }: { index: number }) {
  const strokeDasharray = dashOf(index)?.join(" ");
  return (
    <svg class="compare-key" viewBox="0 0 26 10" aria-hidden="true">
      <path d="M1 5h24" style={{ stroke: `var(${colourOf(index)})`, strokeDasharray }} />
    </svg>
  );
}
