/** How a sweep stands, in short. */

import type { Sweep } from "../api/types";
import { count, short } from "../ui/format";
import { STATES } from "../run/RunStatus";
import "./sweeps.css";

export const sweepTitle = ({ name, id }: Sweep) => name ?? `Sweep ${short(id)}`;

/** How many runs there are, and of what: “3 seeds × 2 viscosities”, in its fields' words. */
export function sizeOf({ seeds, grid, cases, total }: Sweep): string {
  const fields = Object.entries(grid).map(([path, values]) => `${values.length} of ${path}`);
  const each = seeds.length > 0 ? [`${count(seeds.length)} ${seeds.length === 1 ? "seed" : "seeds"}`] : [];
  const factors = [...each, ...fields].join(" × ");
  const left = total < cases.length * Math.max(1, seeds.length);
  return `${count(total)} ${total === 1 ? "run" : "runs"}${left ? " left" : ""}: ${factors}`;
}

export function SweepProgress({ sweep }: { sweep: Sweep }) {
  const share = Math.round(1000 * sweep.progress) / 10;
  const alive = Boolean(sweep.standing.running);
  return (
    <div
      class={`progress ${alive ? "running" : ""}`}
      role="progressbar"
      aria-label="Progress of all runs"
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
      {STATES.filter((state) => sweep.standing[state]).map((state) => (
        <span key={state} class={`badge ${state}`}>
          {sweep.standing[state]} {state}
        </span>
      ))}
    </span>
  );
}
