/** The columns of the list of runs, which of them are shown, and by what runs are grouped. */

import type { ComponentChildren } from "preact";
import type { Run } from "../api/types";
import { keyFigureOf } from "../run/figures";
import { RunProgress, StatusBadge, timeOf } from "../run/RunStatus";
import { DASH, count, dateTime, number, percent } from "../ui/format";
import { text } from "./text";

export interface RunColumn {
  id: string;
  title: string;
  /** The order that a click on the heading asks for; without it there is none. */
  key?: string;
  /** True if the first click puts the highest first. */
  falling?: boolean;
  kind?: string;
  cell: (run: Run, name: string) => ComponentChildren;
}

export const COLUMNS: readonly RunColumn[] = [
  { id: "state", title: text.state, key: "status", cell: (run) => <StatusBadge run={run} /> },
  {
    id: "progress",
    title: text.progress,
    key: "progress",
    falling: true,
    kind: "with-bar",
    cell: progressOf,
  },
  { id: "time", title: text.time, kind: "time", cell: timeCell },
  {
    id: "rate",
    title: text.evaluationsPerSecond,
    cell: (run) => number(run.evaluations_per_second),
  },
  { id: "result", title: text.result, key: "qd_score", falling: true, kind: "with-spark", cell: resultOf },
  { id: "best", title: text.best, key: "best", falling: true, cell: (run) => number(run.best) },
  {
    id: "coverage",
    title: text.coverage,
    key: "coverage",
    falling: true,
    cell: (run) => percent(run.coverage),
  },
  {
    id: "evaluations",
    title: text.evaluations,
    key: "evaluations",
    falling: true,
    cell: (run) => count(run.evaluations),
  },
  { id: "viscosity", title: text.viscosity, cell: (run) => number(partOf(run, "world", "viscosity")) },
  { id: "seed", title: text.seed, cell: (run) => (typeof run.spec.seed === "number" ? run.spec.seed : DASH) },
  { id: "owner", title: text.owner, cell: (run) => run.owner ?? DASH },
  {
    id: "created",
    title: text.created,
    key: "created",
    falling: true,
    cell: (run) => dateTime(run.created_at),
  },
];

/** The columns of a list that nobody has changed. */
export const USUAL = ["state", "progress", "time", "rate", "result"];

/** The columns in the address, in the order of `COLUMNS`; unknown ones are ignored. */
export function columnsOf(address: URLSearchParams): readonly RunColumn[] {
  const named = address.get("columns");
  const wanted = named === null ? USUAL : named.split(",");
  return COLUMNS.filter(({ id }) => wanted.includes(id));
}

/** For the address: null for the usual columns. */
export function columnsParameter(wanted: readonly string[]): string | null {
  const ids = COLUMNS.map(({ id }) => id).filter((id) => wanted.includes(id));
  return ids.join() === USUAL.join() ? null : ids.join();
}

function progressOf(run: Run) {
  return (
    <>
      <RunProgress run={run} />
      <span class="quiet">
        {run.generation} / {run.generations}
      </span>
    </>
  );
}

function timeCell(run: Run) {
  const time = timeOf(run);
  return (
    <>
      {time.text}
      {run.status === "running" && time.text !== DASH && <span class="quiet"> {text.left}</span>}
    </>
  );
}

function resultOf(run: Run, name: string) {
  const [title, figure] = keyFigureOf(run);
  return (
    <>
      <span>
        {figure} <span class="quiet small">{title}</span>
      </span>
      {run.sparkline.length > 1 && <Sparkline values={run.sparkline} label={text.sparkline(name)} />}
    </>
  );
}

function partOf({ spec }: Run, part: string, field: string): number | null {
  const value = (spec[part] as Record<string, unknown> | undefined)?.[field];
  return typeof value === "number" ? value : null;
}

const OF_GROUP: Record<string, (run: Run) => string> = {
  state: (run) => run.status,
  experiment: (run) => run.experiment,
  viscosity: (run) => number(partOf(run, "world", "viscosity")),
  tag: (run) => run.tags.join(", ") || text.untagged,
  owner: (run) => run.owner ?? text.nobody,
};

export const GROUPINGS = [
  ["", text.notGrouped],
  ["state", text.state],
  ["experiment", text.experiment],
  ["viscosity", text.viscosity],
  ["tag", text.tag],
  ["owner", text.owner],
] as const;

/** The choice in the address; unknown ones are ignored. */
export function groupingOf(address: URLSearchParams): string {
  const given = address.get("group") ?? "";
  return Object.hasOwn(OF_GROUP, given) ? given : "";
}

/** The group of a run; empty without a grouping, and for a run that was just removed for good. */
export const groupName = (run: Run | undefined, grouping: string): string =>
  (run && OF_GROUP[grouping]?.(run)) ?? "";

/** The places of each group; groups and their members keep the order of the list. */
export function groupedBy(names: readonly string[]): [name: string, places: number[]][] {
  const groups = new Map<string, number[]>();
  names.forEach((name, place) => groups.set(name, [...(groups.get(name) ?? []), place]));
  return [...groups];
}

const [WIDTH, HEIGHT, MARGIN] = [96, 24, 2];

/** A run's QD score in a line of text's height. */
function Sparkline({ values, label }: { values: number[]; label: string }) {
  if (values.length < 2) return <span class="quiet">–</span>;
  const low = Math.min(...values);
  const span = Math.max(...values) - low || 1;
  const points = values.map((value, i) => {
    const x = MARGIN + ((WIDTH - 2 * MARGIN) * i) / (values.length - 1);
    const y = HEIGHT - MARGIN - ((HEIGHT - 2 * MARGIN) * (value - low)) / span;
    return `${x.toFixed(1)},${y.toFixed(1)}`;
  });
  const [x, y] = points.at(-1)!.split(",");
  return (
    <svg class="sparkline" viewBox={`0 0 ${WIDTH} ${HEIGHT}`} role="img" aria-label={label}>
      <polyline points={points.join(" ")} />
      <circle cx={x} cy={y} r="2" />
    </svg>
  );
}
