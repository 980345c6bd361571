/** The table of runs, in groups if the address asks for them. */

import { Fragment } from "preact";
import { useEffect, useState } from "preact/hooks";
import type { Experiment, RunQuery } from "../api/types";
import { readTankBatch, usePoses } from "../store/poses";
import { setQuery } from "../store/router";
import { useEach } from "../store/store";
import { Heading } from "../ui/Table";
import { ariaSort, nextSort } from "./Filters";
import { RunRow } from "./RunRow";
import { type RunColumn, columnsOf, groupName, groupedBy, groupingOf } from "./columns";
import { text } from "./text";

/** The list of all tags, for the fields of new ones. */
export const TAGS_ID = "known-tags";

interface TableProps {
  query: RunQuery;
  address: URLSearchParams;
  listed: readonly string[];
  experiments: Experiment[];
  selected: string[];
  onSelect: (id: string) => void;
}

export function RunTable({ query, address, experiments, selected, onSelect, ...now }: TableProps) {
  const columns = columnsOf(address);
  const grouping = groupingOf(address);
  const namesNow = useEach(now.listed, ({ runs }, id) => groupName(runs.get(id), grouping));
  const [{ listed, names }, follow] = useStill({ listed: now.listed, names: namesNow });
  const groups = groupedBy(names);
  const faces = useEach(listed, ({ runs }, id) => runs.get(id)?.face ?? null);
  const poses = usePoses(
    readTankBatch,
    faces.filter((face) => face !== null).map((creature) => ({ creature })),
  );
  if (listed.length === 0) return null;
  return (
    <table class="runs" {...follow}>
      <Head query={query} columns={columns} />
      <tbody>
        {groups.map(([name, places]) => (
          <Fragment key={name}>
            {grouping && <GroupRow name={name} count={places.length} span={columns.length + 4} />}
            {places.map((place) => (
              <RunRow
                key={listed[place]}
                id={listed[place]!}
                face={(faces[place] && poses.get(faces[place])) || null}
                columns={columns}
                experiments={experiments}
                selected={selected.includes(listed[place]!)}
                knownTags={TAGS_ID}
                onSelect={() => onSelect(listed[place]!)}
              />
            ))}
          </Fragment>
        ))}
      </tbody>
    </table>
  );
}

/** The rows as they were when a text field was opened in one: a row that moved or left would end it. */
function useStill<T>(rows: T) {
  const [still, setStill] = useState<T | null>(null);
  const follow = ({ type, target }: FocusEvent) =>
    setStill(type === "focusin" && (target as Element).matches(".inline-text") ? rows : null);
  // Some browsers tell of no lost focus when the field itself is removed.
  useEffect(() => {
    if (still && !document.activeElement?.matches(".inline-text")) setStill(null);
  });
  return [still ?? rows, { onFocusIn: follow, onFocusOut: follow }] as const;
}

function Head({ query, columns }: { query: RunQuery; columns: readonly RunColumn[] }) {
  const sorted = (key: string, falling: boolean) => ({
    order: ariaSort(query.sort, key),
    onSort: () => setQuery({ sort: nextSort(query.sort, key, falling) }),
  });
  return (
    <thead>
      <tr>
        <th scope="col">
          <span class="unseen">{text.compare}</span>
        </th>
        <th scope="col">
          <span class="unseen">{text.face}</span>
        </th>
        <Heading title={text.run} {...sorted("name", false)} />
        {columns.map(({ id, title, key, falling = false }) => (
          <Heading key={id} title={title} {...(key && sorted(key, falling))} />
        ))}
        <th scope="col">
          <span class="unseen">{text.actions}</span>
        </th>
      </tr>
    </thead>
  );
}

function GroupRow({ name, count, span }: { name: string; count: number; span: number }) {
  return (
    <tr class="group-row">
      <th scope="rowgroup" colSpan={span}>
        {name} <span class="quiet small">{count}</span>
      </th>
    </tr>
  );
}
