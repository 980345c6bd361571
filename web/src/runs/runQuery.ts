/** Filters and order of the list of runs, in the address and in the request. */

import type { RunQuery } from "../api/types";
import { STATES } from "../run/RunStatus";
import { isUuid } from "../store/router";
import type { SortOrder } from "../ui/Table";
import { text } from "./text";

export const NEWEST = "-created";

type Sort = NonNullable<RunQuery["sort"]>;

export const ORDERS = Object.entries(text.orders) as [sort: Sort, title: string][];

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

export const NO_FILTERS = { q: null, status: null, experiment: null, tag: null, sweep: null };

/** In place of a sweep id: runs outside sweeps. */
export const WITHOUT_SWEEP = "none";

const listOf = (address: URLSearchParams, key: string) => (address.get(key) ?? "").split(",").filter(Boolean);

export const isFiltered = ({ sort: _, deleted: __, ...filters }: RunQuery) => Object.keys(filters).length > 0;

/** True if each sweep is shown as one row: while the address asks for nothing. */
export const groupsSweeps = (query: RunQuery) => Object.keys(query).length === 0;

/** The order after a click on a column: by the column, then reversed, then the default. */
export function nextSort(sort: string | undefined, key: string, falling: boolean): string | null {
  const [first, second] = falling ? [`-${key}`, key] : [key, `-${key}`];
  if (sort === first) return second;
  return sort === second ? null : first;
}

export function ariaSort(sort: string | undefined, key: string): SortOrder {
  if (sort === key) return "ascending";
  return sort === `-${key}` ? "descending" : "none";
}
