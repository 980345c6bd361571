/** Estimated costs: time, memory, evaluations and work, and errors that the server finds. */

import * as api from "../api/client";
import { Problem, messageOf } from "../api/problem";
import type { Estimate, Experiment, FieldError, Preset, SweepEstimate } from "../api/types";
import { useFetched } from "../store/fetch";
import { text } from "./text";
import type { ComponentChildren } from "preact";
import { Card } from "../ui/Page";
import { Term } from "../ui/Term";
import { bytes, count, number, words } from "../ui/format";

const TYPING_PAUSE_MS = 350;

/** An error of the server: its fields, and a sentence. */
export function serverErrors(error: unknown): { errors: FieldError[]; problem: string } {
  const errors = error instanceof Problem ? error.errors : [];
  return { errors, problem: errors.length > 0 ? text.hasErrors : messageOf(error) };
}

interface Check<T> {
  estimate: T | null;
  errors: FieldError[];
  problem: string | null;
}

/** Ask for an estimate after a pause in typing; the last answer stays until the next one. */
export function useEstimate<Requested, T>(
  requested: Requested | null,
  estimateOf: (requested: Requested) => Promise<T>,
): Check<T> {
  const ask = async (): Promise<Check<T>> => {
    if (requested === null) return UNCHECKED;
    return estimateOf(requested).then(
      (estimate) => ({ ...UNCHECKED, estimate }),
      (error) => ({ ...UNCHECKED, ...serverErrors(error) }),
    );
  };
  const { value } = useFetched(ask, [requested], TYPING_PAUSE_MS);
  return (requested !== null && value) || UNCHECKED;
}

const UNCHECKED = { estimate: null, errors: [], problem: null };

/** The estimated cost of each preset of an experiment; a preset without an answer shows none. */
export function usePresetCosts({ presets }: Experiment): ReadonlyMap<Preset, Estimate> {
  const costOf = async (preset: Preset) => [preset, await api.estimateRun(preset.spec)] as const;
  const { value } = useFetched(() => Promise.allSettled(presets.map(costOf)), [presets]);
  return new Map(value?.flatMap((one) => (one.status === "fulfilled" ? [one.value] : [])));
}

interface Props {
  estimate: Estimate | SweepEstimate | null;
  runs?: number;
  problem: string | null;
}

export function Costs({ estimate, runs = 1, problem }: Props) {
  if (problem || !estimate) {
    return (
      <p class={`costs ${problem ? "wrong-text" : "quiet"}`} role="status">
        {problem ?? text.estimating}
      </p>
    );
  }
  const { memory_bytes, memory_limit_bytes, evaluations } = estimate;
  const { queue, seconds } = estimate;
  const shared = runs > 1 && seconds !== null && queue.workers > 1;
  return (
    <dl class="costs row" aria-label={text.estimate}>
      <Cost name={runs > 1 ? text.timeOfRuns(count(runs)) : text.time}>
        {timeText(estimate) ?? text.unknown}
        {shared && (
          <span class="quiet">{text.onWorkers(queue.workers, roughDuration(seconds / queue.workers))}</span>
        )}
      </Cost>
      <Cost name={runs > 1 ? text.memoryEach : text.memory} wrong={memory_bytes > memory_limit_bytes}>
        {bytes(memory_bytes)} <span class="quiet">{text.ofMemory(bytes(memory_limit_bytes))}</span>
      </Cost>
      <Cost name={text.evaluations}>{count(evaluations)}</Cost>
    </dl>
  );
}

interface CostProps {
  name: string;
  wrong?: boolean;
  children: ComponentChildren;
}

function Cost({ name, wrong = false, children }: CostProps) {
  return (
    <div class={wrong ? "wrong-text" : ""}>
      <dt>
        <Term name={name} />
      </dt>
      <dd>{children}</dd>
    </div>
  );
}

export function CostDetails({ estimate }: { estimate: Estimate }) {
  const { memory_bytes, memory_limit_bytes, evaluations, cell_steps, speed } = estimate;
  const fits = memory_bytes <= memory_limit_bytes;
  const memory = text.memoryNeeded(bytes(memory_limit_bytes), fits);
  const rate = speed ? text.rate(number(speed.cell_steps_per_second)) : "";
  return (
    <Card id="cost" kind="cost-details" title={text.cost}>
      <Detail value={words(timeText(estimate) ?? text.time)} about={`${estimateBasis(estimate)}.`} />
      <Detail value={bytes(memory_bytes)} about={memory} wrong={!fits} />
      <Detail value={count(evaluations)} about={text.evaluationsAbout} />
      <Detail value={number(cell_steps)} about={`${text.cellSteps}${rate}`} />
      <p class="quiet">{waitText(estimate)}</p>
    </Card>
  );
}

function Detail({ value, about, wrong = false }: { value: string; about: string; wrong?: boolean }) {
  return (
    <p>
      <b>{value}</b> <span class={wrong ? "wrong-text" : "quiet"}>{about}</span>
    </p>
  );
}

export function roughDuration(seconds: number): string {
  if (seconds < 10) return "10 s";
  if (seconds < 90) return `${5 * Math.round(seconds / 5)} s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
  if (seconds < 36 * 3600) return `${Math.round((10 * seconds) / 3600) / 10} h`;
  return seconds < 365 * 86400 ? text.days(Math.round(seconds / 86400)) : text.overAYear;
}

/** The rounded time; null if unknown. */
export function timeText({ seconds }: Pick<Estimate, "seconds">): string | null {
  if (seconds === null) return null;
  return seconds < 10 ? text.fewSeconds : text.about(roughDuration(seconds));
}

/** The range is shown if the slowest and the fastest earlier run differ by this factor. */
const MIN_RATIO = 1.5;

export function estimateBasis({ speed }: Estimate): string {
  if (!speed) return text.unknownTime;
  const [low, high] = [roughDuration(speed.low), roughDuration(speed.high)];
  const wide = speed.high > MIN_RATIO * speed.low && low !== high;
  const range = wide ? text.timeRange(low, high) : "";
  return text.basis(speed.device, text.basedOn(speed.runs), range);
}

export function waitText({ queue }: Estimate): string {
  const { runs_ahead, workers, idle_workers } = queue;
  if (workers === 0) return text.noWorker;
  if (runs_ahead > 0) return text.queued(runs_ahead);
  return idle_workers > 0 ? text.workerFree : text.workerBusy;
}
