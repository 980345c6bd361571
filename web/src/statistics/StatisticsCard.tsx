/** Statistics of finished runs: figures of their groups, rank tests and effect sizes, and their files. */

import { statisticsUrl } from "../api/files";
import type { ComparedRuns, MeasureStatistics, Statistics } from "../api/types";
import { capitalised, count, number, percent } from "../ui/format";
import { FileLink } from "../ui/links";
import { Card } from "../ui/Page";
import { type Column, Table } from "../ui/Table";
import { text } from "./text";
import "./statistics.css";
import * as api from "../api/client";
import { type Loaded, useFetched } from "../store/fetch";
import { useThrottled } from "../store/polling";
import { type State, epochOf } from "../store/state";
import { useStore } from "../store/store";

const MEASURES = ["qd_score", "coverage", "best"];

interface Props {
  of: ComparedRuns;
  /** True if all have a corrected QD score. */
  corrected: boolean;
}

export function StatisticsCard({ of, corrected }: Props) {
  const measures = [...MEASURES, ...(corrected ? ["corrected_qd_score"] : [])].join();
  const { value, error } = useStatistics(of, measures);
  const files = (
    <>
      <FileLink url={statisticsUrl("csv", of, measures)} name={text.csv} title={text.csvAbout} />
      <FileLink url={statisticsUrl("tex", of, measures)} name={text.latex} title={text.latexAbout} />
    </>
  );
  return (
    <Card
      id="statistics"
      kind="statistics"
      title={text.statistics}
      note={"sweep" in of ? text.byCase : text.bySpec}
      actions={value && files}
    >
      {error && <p class="banner warning">{error}</p>}
      {!value && !error && <p class="quiet loading">{text.computing}</p>}
      {value && <Comparison {...value} />}
    </Card>
  );
}

function Comparison(found: Statistics) {
  const pairs = pairsOf(found.measures);
  const overall = found.measures.filter((one) => one.overall !== null);
  return (
    <>
      <p class="small">{found.groups_in_words}</p>
      <div class="statistics-tables">
        <Table label={text.figures} columns={FIGURES} rows={summariesOf(found.measures)} keyOf={keyOf} />
        <div>
          {pairs.length > 0 && (
            <Table label={text.tests} kind="pairs" columns={PAIRS} rows={pairs} keyOf={keyOf} />
          )}
          {overall.length > 0 && (
            <Table label={text.overall} columns={OVERALL} rows={overall} keyOf={({ measure }) => measure} />
          )}
        </div>
      </div>
      {[found.method, ...found.cautions].map((said) => (
        <p key={said} class="quiet small">
          {said}
        </p>
      ))}
    </>
  );
}

const keyOf = ({ key }: { key: string }) => key;

type Summary = ReturnType<typeof summariesOf>[number];
type Pair = ReturnType<typeof pairsOf>[number];

const FIGURES: Column<Summary>[] = [
  { title: text.measure, cell: ({ named }) => named },
  { title: text.group, cell: ({ group }) => group.group },
  { title: text.runs, cell: ({ group }) => count(group.n) },
  {
    title: text.median,
    cell: ({ measure, group: { median, low, high } }) => (
      <Figure value={formatOf(measure)(median)} range={intervalText(measure, low, high)} />
    ),
  },
  {
    title: text.middleMean,
    cell: ({ measure, group: { iqm, iqm_low, iqm_high } }) => (
      <Figure
        value={formatOf(measure)(iqm)}
        range={iqm_low === null ? "" : intervalText(measure, iqm_low, iqm_high)}
      />
    ),
  },
];

const OVERALL: Column<MeasureStatistics>[] = [
  { title: text.measure, cell: ({ title }) => capitalised(title) },
  { title: text.statistic, cell: ({ overall }) => overall!.statistic.toFixed(2) },
  { title: text.plain, cell: ({ overall }) => probability(overall!.p) },
];

const PAIRS: Column<Pair>[] = [
  { title: text.measure, cell: ({ named }) => named },
  { title: text.first, cell: ({ pair }) => pair.group },
  { title: text.second, cell: ({ pair }) => pair.other },
  {
    title: text.corrected,
    cell: ({ pair }) => {
      const said = probability(pair.p_holm);
      return pair.p_holm < 0.05 ? <b>{said}</b> : said;
    },
  },
  {
    title: text.superiority,
    cell: ({ pair: { a12, a12_low, a12_high } }) => (
      <Figure value={a12.toFixed(2)} range={text.range(a12_low.toFixed(2), a12_high.toFixed(2))} />
    ),
  },
];

function Figure({ value, range }: { value: string; range: string }) {
  return (
    <span>
      <b>{value}</b>
      {range && <span class="quiet small spread">{range}</span>}
    </span>
  );
}

const SHARES = ["coverage", "corrected_coverage", "hit_rate"];

/** A number of a measure; null where a run does not reach the value, or has no elites. */
export const formatOf =
  ({ measure, less_is_better }: MeasureStatistics) =>
  (value: number | null): string => {
    if (value === null) return less_is_better ? text.notReached : text.noElites;
    if (less_is_better) return count(value);
    return SHARES.includes(measure.replace(/@.*/, "")) ? percent(value) : number(value);
  };

export const intervalText = (measure: MeasureStatistics, low: number | null, high: number | null) =>
  text.range(formatOf(measure)(low), formatOf(measure)(high));

export const probability = (p: number) => (p < 0.001 ? text.under : p.toFixed(3));

/** A row for each measure and group; the first of a measure names it. */
export const summariesOf = (measures: MeasureStatistics[]) =>
  measures.flatMap((measure) =>
    measure.groups.map((group, i) => ({
      key: `${measure.measure} ${group.group}`,
      named: i === 0 ? capitalised(measure.title) : "",
      measure,
      group,
    })),
  );

/** A row for each measure and pair of groups; the first of a measure names it. */
export const pairsOf = (measures: MeasureStatistics[]) =>
  measures.flatMap((measure) =>
    measure.pairs.map((pair, i) => ({
      key: `${measure.measure} ${pair.group} ${pair.other}`,
      named: i === 0 ? capitalised(measure.title) : "",
      pair,
    })),
  );

/** Statistics of runs that have ended, read again when one of them changes. */
function useStatistics(of: ComparedRuns, measures: string): Loaded<Statistics> {
  const version = useThrottled(useStore((state) => versionOf(state, of)));
  const asked = Object.values(of).join();
  return useFetched(() => api.readStatistics(of, measures), [asked, version, measures]);
}

function versionOf(state: State, of: ComparedRuns): string {
  if ("sweep" in of) return `${state.epoch} ${state.sweepVersions.get(of.sweep) ?? 0}`;
  return of.runs
    .split(",")
    .map((id) => epochOf(state, id))
    .join();
}
