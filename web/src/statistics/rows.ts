/** Rows of the tables of statistics, and numbers as text. */

import type { MeasureStatistics } from "../api/types";
import { count, number, percent } from "../ui/format";
import { text } from "./text";

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

export const capitalised = (title: string) => title.charAt(0).toUpperCase() + title.slice(1);

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
