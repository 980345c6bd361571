/** Which runs a list shows and in which order: between the address and the query. */

import type { RunQuery } from "../api/types";
import { STATES } from "../run/RunStatus";

export const NEWEST = "-created";

/** Orders as a menu has them. */
export const ORDERS: [sort: NonNullable<RunQuery["sort"]>, title: string][] = [
  [NEWEST, "Newest first"],
  ["created", "Oldest first"],
  ["name", "Name"],
  ["-name", "Name, from the end"],
  ["status", "State"],
  ["-status", "State, from the end"],
  ["-progress", "Most progress"],
  ["progress", "Least progress"],
  ["-evaluations", "Most evaluations"],
  ["evaluations", "Fewest evaluations"],
  ["-qd_score", "Highest QD score"],
  ["qd_score", "Lowest QD score"],
  ["-best", "Highest fitness"],
  ["best", "Lowest fitness"],
];

/** What the address asks for; words that make no sense there are passed over. */
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
    ...(sweep && (sweep === WITHOUT_SWEEP || UUID.test(sweep)) && { sweep }),
    ...(address.get("deleted") === "true" && { deleted: true }),
    ...(sort && sort !== NEWEST && { sort }),
  };
}

/** What shows everything again. */
export const NO_FILTERS = { q: null, status: null, experiment: null, tag: null, sweep: null };

/** Instead of a sweep: runs that belong to none. */
export const WITHOUT_SWEEP = "none";
const UUID = /^[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}$/i;

const listOf = (address: URLSearchParams, key: string) => (address.get(key) ?? "").split(",").filter(Boolean);

/** Whether anything is left out. */
export const isFiltered = ({ sort: _, deleted: __, ...filters }: RunQuery) => Object.keys(filters).length > 0;

/** What to ask the server for: as long as nothing is asked of them, runs of sweeps stand as one. */
export const groupsSweeps = (query: RunQuery) => Object.keys(query).length === 0;

/** The order after one more click on a column: its own first, then reversed, then the usual. */
export function nextSort(sort: string | undefined, key: string, falling: boolean): string | null {
  const [first, second] = falling ? [`-${key}`, key] : [key, `-${key}`];
  if (sort === first) return second;
  return sort === second ? null : first;
}

export function ariaSort(sort: string | undefined, key: string) {
  if (sort === key) return "ascending";
  return sort === `-${key}` ? "descending" : "none";
}
