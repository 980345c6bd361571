/** Filters and order of the list of runs, in the address and in the request. */

import type { RunQuery } from "../api/types";
import { STATES } from "../run/RunStatus";
import { isUuid } from "../store/router";
import { text } from "./text";

export const NEWEST = "-created";

/** The orders of the menu. */
export const ORDERS: [sort: NonNullable<RunQuery["sort"]>, title: string][] = [
  [NEWEST, text.newest],
  ["created", text.oldest],
  ["name", text.name],
  ["-name", text.nameFalling],
  ["status", text.stateRising],
  ["-status", text.stateFalling],
  ["-progress", text.mostProgress],
  ["progress", text.leastProgress],
  ["-evaluations", text.mostEvaluations],
  ["evaluations", text.fewestEvaluations],
  ["-qd_score", text.highestQdScore],
  ["qd_score", text.lowestQdScore],
  ["-best", text.highestFitness],
  ["best", text.lowestFitness],
];

/** The query of an address; unknown values are ignored. */
export function queryOf(address: URLSearchParams): RunQuery {
  const status = STATES.filter((state) => listOf(address, "status").includes(state));
  const experiment = listOf(address, "experiment");
  const [q, tag, sweep] = ["q", "tag", "sweep"].map((key) => address.get(key));
  const sort = ORDERS.find(([each]) => each === address.get("sort"))?.[0];
  return {
    ...(status.length > 0 && { status }),
    ...(experiment.length > 0 && { experiment }),
    ...(q && { q }),
    ...(tag && { tag }),
    ...(sweep && (sweep === WITHOUT_SWEEP || isUuid(sweep)) && { sweep }),
    ...(address.get("deleted") === "true" && { deleted: true }),
    ...(sort && sort !== NEWEST && { sort }),
  };
}

/** Removes all filters. */
export const NO_FILTERS = { q: null, status: null, experiment: null, tag: null, sweep: null };

/** In place of a sweep id: runs outside sweeps. */
export const WITHOUT_SWEEP = "none";

const listOf = (address: URLSearchParams, key: string) => (address.get(key) ?? "").split(",").filter(Boolean);

/** True if any filter is set. */
export const isFiltered = ({ sort: _, deleted: __, ...filters }: RunQuery) => Object.keys(filters).length > 0;

/** What to ask the server for: as long as nothing is asked of them, runs of sweeps stand as one. */
export const groupsSweeps = (query: RunQuery) => Object.keys(query).length === 0;

/** The order after a click on a column: by the column, then reversed, then the default. */
export function nextSort(sort: string | undefined, key: string, falling: boolean): string | null {
  const [first, second] = falling ? [`-${key}`, key] : [key, `-${key}`];
  if (sort === first) return second;
  return sort === second ? null : first;
}

export function ariaSort(sort: string | undefined, key: string) {
  if (sort === key) return "ascending";
  return sort === `-${key}` ? "descending" : "none";
}
