/** Filters and order of the list of runs, in the form, the address and the request. */

import { useState } from "preact/hooks";
import type { Experiment, RunQuery } from "../api/types";
import { useDebounced } from "../store/polling";
import { Select } from "../ui/Select";
import { words } from "../ui/format";
import { STATES } from "../run/RunStatus";
import { text } from "./text";
import { isUuid } from "../store/router";
import type { SortOrder } from "../ui/Table";

type Pair = [value: string, title: string];
type Selection = [name: string, title: string, value: string | undefined, choices: Pair[]];
const TYPING_PAUSE_MS = 200;

interface Props {
  query: RunQuery;
  experiments: Experiment[];
  tags: string[];
  onChange: (changes: Record<string, string | null>) => void;
}

export function Filters({ query, experiments, tags, onChange }: Props) {
  const [typed, setTyped] = useState<string | null>(null);
  const find = (query: string) => {
    setTyped(null);
    onChange({ q: query || null });
  };
  useDebounced(typed, TYPING_PAUSE_MS, find);
  return (
    <form
      class="filters row"
      role="search"
      aria-label={text.runs}
      onSubmit={(event) => {
        event.preventDefault();
        if (typed !== null) find(typed);
      }}
    >
      <input
        type="search"
        aria-label={text.find}
        placeholder={text.findHint}
        maxLength={200}
        value={typed ?? query.q ?? ""}
        onInput={(event) => setTyped(event.currentTarget.value)}
      />
      <Selects {...{ query, experiments, tags, onChange }} />
      {isFiltered(query) && (
        <button
          type="button"
          class="plain"
          onClick={() => {
            setTyped(null);
            onChange(NO_FILTERS);
          }}
        >
          {text.showAll}
        </button>
      )}
    </form>
  );
}

function Selects({ query, experiments, tags, onChange }: Props) {
  const knownTags = query.tag && !tags.includes(query.tag) ? [query.tag, ...tags] : tags;
  const selects: Selection[] = [
    ["status", text.state, query.status?.[0], STATES.map((state) => [state, words(state)])],
    [
      "experiment",
      text.experiment,
      query.experiment?.[0],
      experiments.map(({ experiment, title }) => [experiment, title]),
    ],
    ["tag", text.tag, query.tag ?? undefined, knownTags.map((tag) => [tag, tag])],
  ];
  if (knownTags.length === 0) selects.pop();
  return (
    <>
      {selects.map(([name, title, value = "", choices]) => (
        <Select
          key={name}
          title={title}
          value={value}
          choices={[["", text.any], ...choices]}
          onChange={(selected) => onChange({ [name]: selected || null })}
        />
      ))}
      <Select
        title={text.order}
        value={query.sort ?? NEWEST}
        choices={ORDERS}
        onChange={(sort) => onChange({ sort: sort === NEWEST ? null : sort })}
      />
    </>
  );
}

const NEWEST = "-created";

type Sort = NonNullable<RunQuery["sort"]>;

const ORDERS = Object.entries(text.orders) as [sort: Sort, title: string][];

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
