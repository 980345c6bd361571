/** What a run will need: memory, evaluations, work. */

import type { Estimate } from "../api/types";
import { bytes, count, number } from "./format";

interface Props {
  estimate: Estimate | null;
  problem: string | null;
}

export function Costs({ estimate, problem }: Props) {
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
  const { memory_bytes, memory_limit_bytes, evaluations, cell_steps } = estimate;
  const share = memory_bytes / memory_limit_bytes;
  return (
    <dl class="costs" aria-label="Estimate">
      <div class={share > 1 ? "wrong-text" : ""}>
        <dt>Memory</dt>
        <dd>
          {bytes(memory_bytes)} <span class="quiet">of {bytes(memory_limit_bytes)}</span>
        </dd>
      </div>
      <div>
        <dt>Evaluations</dt>
        <dd>{count(evaluations)}</dd>
      </div>
      <div>
        <dt>Cell steps</dt>
        <dd>{number(cell_steps)}</dd>
      </div>
    </dl>
  );
}
