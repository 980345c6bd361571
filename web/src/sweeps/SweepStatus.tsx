/** Title, size and progress of a sweep. */

import type { Sweep } from "../api/types";
import { shortId } from "../ui/format";
import { Progress } from "../ui/Page";
import { STATES } from "../run/RunStatus";
import { text } from "./text";
import "./sweeps.css";

export const sweepTitle = ({ name, id }: Sweep) => name ?? text.sweepTitle(shortId(id));

/** The number of runs with its factors: “6 runs: 3 seeds × 2 values of world.viscosity”. */
export function sizeText({ seeds, grid, total }: Sweep): string {
  const fields = Object.entries(grid).map(([path, values]) => text.valuesOf(values.length, path));
  const each = seeds.length > 0 ? [text.seeds(seeds.length)] : [];
  const factors = [...each, ...fields].join(" × ");
  const cases = Object.values(grid).reduce((product, values) => product * values.length, 1);
  const left = total < cases * Math.max(1, seeds.length);
  return text.size(total, left, factors);
}

export function SweepProgress({ sweep }: { sweep: Sweep }) {
  const kind = sweep.status_counts.running ? "running" : "";
  return <Progress label={text.progress} share={sweep.progress} kind={kind} />;
}

export function SweepStates({ sweep }: { sweep: Sweep }) {
  return (
    <span class="sweep-states row">
      {STATES.filter((state) => sweep.status_counts[state]).map((state) => (
        <span key={state} class={`badge ${state}`}>
          {sweep.status_counts[state]} {state}
        </span>
      ))}
    </span>
  );
}
