/** What a run will need: time, memory, evaluations, work. */

import type { Estimate, SweepEstimate } from "../api/types";
import { about, basis, rough, wait } from "./costText";
import { bytes, count, number, words } from "../ui/format";

interface Props {
  estimate: Estimate | SweepEstimate | null;
  /** How many runs it is for. */
  runs?: number;
  problem: string | null;
}

/** In short, beside the button that starts the run. */
export function Costs({ estimate, runs = 1, problem }: Props) {
  if (problem) {
    return (
      <p class="costs wrong-text" role="status">
        {problem}
      </p>
    );
  }
  if (!estimate) {
    return (
      <p class="costs quiet" role="status">
        Estimating …
      </p>
    );
  }
  const { memory_bytes, memory_limit_bytes, evaluations } = estimate;
  return (
    <dl class="costs" aria-label="Estimate">
      <div>
        <dt>{runs > 1 ? `Time of ${count(runs)} runs` : "Time"}</dt>
        <dd>
          {about(estimate) ?? "unknown yet"}
          {runs > 1 && estimate.seconds !== null && <PerWorker estimate={estimate} />}
        </dd>
      </div>
      <div class={memory_bytes > memory_limit_bytes ? "wrong-text" : ""}>
        <dt>{runs > 1 ? "Memory of each" : "Memory"}</dt>
        <dd>
          {bytes(memory_bytes)} <span class="quiet">of {bytes(memory_limit_bytes)}</span>
        </dd>
      </div>
      <div>
        <dt>Evaluations</dt>
        <dd>{count(evaluations)}</dd>
      </div>
    </dl>
  );
}

/** Several workers share the runs. */
function PerWorker({ estimate: { seconds, queue } }: { estimate: Estimate | SweepEstimate }) {
  if (queue.workers < 2) return null;
  return (
    <span class="quiet">
      , on {queue.workers} workers {rough(seconds! / queue.workers)}
    </span>
  );
}

/** In full: on what it rests, and what the words mean. */
export function CostDetails({ estimate }: { estimate: Estimate }) {
  const { memory_bytes, memory_limit_bytes, evaluations, cell_steps, speed } = estimate;
  const fits = memory_bytes <= memory_limit_bytes;
  return (
    <section class="card cost-details" aria-labelledby="cost-title">
      <h2 id="cost-title">What it will cost</h2>
      <p>
        <b>{words(about(estimate) ?? "Time")}</b> <span class="quiet">{basis(estimate)}.</span>
      </p>
      <p>
        <b>{bytes(memory_bytes)}</b>{" "}
        <span class={fits ? "quiet" : "wrong-text"}>
          of memory at most; {fits ? "" : "only "}
          {bytes(memory_limit_bytes)} {fits ? "are there" : "are there, so it would be refused"}.
        </span>
      </p>
      <p>
        <b>{count(evaluations)}</b> <span class="quiet">evaluations: simulated lives.</span>
      </p>
      <p>
        <b>{number(cell_steps)}</b>{" "}
        <span class="quiet">
          cell steps, the unit of work: one cell of fluid brought forward by one step.
          {speed && ` Here ${number(speed.cell_steps_per_second)} of them take a second.`}
        </span>
      </p>
      <p class="quiet">{wait(estimate)}</p>
    </section>
  );
}
