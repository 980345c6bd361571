/** Title, size and progress of a sweep. */

import type { Sweep } from "../api/types";
import { short } from "../ui/format";
import { STATES } from "../run/RunStatus";
import { text } from "./text";
import "./sweeps.css";

export const sweepTitle = ({ name, id }: Sweep) => name ?? text.sweepTitle(short(id));

/** Number of runs and how it comes about: “6 runs: 3 seeds × 2 viscosity”. */
export function sizeOf({ seeds, grid, cases, total }: Sweep): string {
  const fields = Object.entries(grid).map(([path, values]) => text.valuesOf(values.length, path));
  const each = seeds.length > 0 ? [text.seeds(seeds.length)] : [];
  const factors = [...each, ...fields].join(" × ");
  const left = total < cases.length * Math.max(1, seeds.length);
  return text.size(total, left, factors);
}

export function SweepProgress({ sweep }: { sweep: Sweep }) {
  const share = Math.round(1000 * sweep.progress) / 10;
  const alive = Boolean(sweep.status_counts.running);
  return (
    <div
      class={`progress ${alive ? "running" : ""}`}
      role="progressbar"
      aria-label={text.progress}
      aria-valuenow={share}
      aria-valuemin={0}
      aria-valuemax={100}
    >
      <div style={{ width: `${share}%` }} />
    </div>
  );
}

/** How many runs are in each state. */
export function SweepStates({ sweep }: { sweep: Sweep }) {
  return (
    <span class="sweep-states">
      {STATES.filter((state) => sweep.status_counts[state]).map((state) => (
        <span key={state} class={`badge ${state}`}>
          {sweep.status_counts[state]} {state}
        </span>
      ))}
    </span>
  );
}
