/** Estimated cost of a run: time, memory, evaluations, work. */

import type { Estimate, SweepEstimate } from "../api/types";
import { about, basis, rough, wait } from "./costText";
import { bytes, count, number, words } from "../ui/format";
import { text } from "./text";

interface Props {
  estimate: Estimate | SweepEstimate | null;
  /** How many runs it is for. */
  runs?: number;
  problem: string | null;
}

/** The estimate in short, beside the start button. */
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
        {text.estimating}
      </p>
    );
  }
  const { memory_bytes, memory_limit_bytes, evaluations } = estimate;
  return (
    <dl class="costs" aria-label={text.estimate}>
      <div>
        <dt>{runs > 1 ? text.timeOfRuns(count(runs)) : text.time}</dt>
        <dd>
          {about(estimate) ?? text.unknown}
          {runs > 1 && estimate.seconds !== null && <PerWorker estimate={estimate} />}
        </dd>
      </div>
      <div class={memory_bytes > memory_limit_bytes ? "wrong-text" : ""}>
        <dt>{runs > 1 ? text.memoryEach : text.memory}</dt>
        <dd>
          {bytes(memory_bytes)} <span class="quiet">{text.ofMemory(bytes(memory_limit_bytes))}</span>
        </dd>
      </div>
      <div>
        <dt>{text.evaluations}</dt>
        <dd>{count(evaluations)}</dd>
      </div>
    </dl>
  );
}

/** Several workers share the runs. */
function PerWorker({ estimate: { seconds, queue } }: { estimate: Estimate | SweepEstimate }) {
  if (queue.workers < 2) return null;
  return <span class="quiet">{text.onWorkers(queue.workers, rough(seconds! / queue.workers))}</span>;
}

/** The estimate in full, with its basis. */
export function CostDetails({ estimate }: { estimate: Estimate }) {
  const { memory_bytes, memory_limit_bytes, evaluations, cell_steps, speed } = estimate;
  const fits = memory_bytes <= memory_limit_bytes;
  return (
    <section class="card cost-details" aria-labelledby="cost-title">
      <h2 id="cost-title">{text.cost}</h2>
      <p>
        <b>{words(about(estimate) ?? text.time)}</b> <span class="quiet">{basis(estimate)}.</span>
      </p>
      <p>
        <b>{bytes(memory_bytes)}</b>{" "}
        <span class={fits ? "quiet" : "wrong-text"}>
          {text.memoryNeeded(bytes(memory_limit_bytes), fits)}
        </span>
      </p>
      <p>
        <b>{count(evaluations)}</b> <span class="quiet">{text.evaluationsAbout}</span>
      </p>
      <p>
        <b>{number(cell_steps)}</b>{" "}
        <span class="quiet">
          {text.cellSteps}
          {speed && text.pace(number(speed.cell_steps_per_second))}
        </span>
      </p>
      <p class="quiet">{wait(estimate)}</p>
    </section>
  );
}
