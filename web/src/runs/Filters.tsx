/** Filters and order of the list of runs. */

import { useState } from "preact/hooks";
import type { Experiment, RunQuery } from "../api/types";
import { useDebounced } from "../store/timing";
import { Select } from "../ui/Select";
import { words } from "../ui/format";
import { STATES } from "../run/RunStatus";
import { NO_FILTERS, NEWEST, ORDERS, isFiltered } from "./runQuery";
import { text } from "./text";

type Pair = [value: string, title: string];
type Selection = [name: string, title: string, value: string | undefined, choices: Pair[]];
/** Delay between the last key and the request. */
const SETTLE_MS = 200;

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
  useDebounced(typed, SETTLE_MS, find);
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
