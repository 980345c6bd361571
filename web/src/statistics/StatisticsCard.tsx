/** Statistics of finished runs: figures of their groups, rank tests and effect sizes, and their files. */

import { statisticsUrl } from "../api/files";
import type { ComparedRuns, MeasureStatistics, Statistics } from "../api/types";
import { useStatistics } from "../store/statistics";
import { count } from "../ui/format";
import { FileLink } from "../ui/links";
import { Card } from "../ui/Page";
import { type Column, Table } from "../ui/Table";
import { capitalised, formatOf, intervalText, pairsOf, probability, summariesOf } from "./rows";
import { text } from "./text";
import "./statistics.css";

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
