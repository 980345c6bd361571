/** The creatures a new run can start from: the selected ones, or a past generation. */

import { useMemo } from "preact/hooks";
import { sharedSlug } from "../api/address";
import type { Run } from "../api/types";
import { useRefusal } from "../store/principal";
import { parseCells, formatCells } from "../store/draft";
import type { Elites } from "../store/elites";
import { setQuery } from "../store/router";
import { type Selection, type CellSet, cellsIn, toggle } from "./selection";
import type { Projection } from "./projection";
import type { Of } from "./reprojection";
import { lazy } from "../ui/lazy";
import { count } from "../ui/format";
import { ForkLink, SideBySide } from "../ui/links";
import { text } from "./text";

const BreedButton = lazy(async () => (await import("../breeding/BreedButton")).BreedButton, null);

const setSelection = (selected: CellSet) =>
  setQuery({ cells: selected.size > 0 ? formatCells(selected) : null });

/** The cells in the address that have an elite. */
export function useSelection(query: URLSearchParams, elites: Elites): Selection {
  const cells = query.get("cells") ?? "";
  const refusal = useRefusal();
  const selected = useMemo(() => {
    const named = parseCells(cells);
    return new Set(cells ? [...elites.keys()].filter(named) : []);
  }, [cells, elites]);
  return { selected, onSelect: sharedSlug || refusal ? null : setSelection };
}

interface OneProps extends Selection {
  cell: number;
  projection: Projection;
}

/** Select or deselect the focused elite, for touch screens. */
export function SelectToggle({ cell, projection, selected, onSelect }: OneProps) {
  const bin = projection.bins.get(cell);
  if (!onSelect || bin === undefined) return null;
  return (
    <button
      class="link"
      aria-pressed={selected.has(cell)}
      onClick={() => onSelect(toggle(selected, cellsIn([bin], projection)))}
    >
      {text.select}
    </button>
  );
}

/** The names of this number of creatures fit into an address. */
const MAX_NAMED = 100;

/** The cells of a re-projection are not the run's, so its creatures are named. */
function ForkByName({ run, names }: { run: string; names: string[] }) {
  if (names.length > MAX_NAMED) return <span class="quiet">{text.tooManyNamed(count(MAX_NAMED))}</span>;
  return <ForkLink run={run} creatures={names} title={text.fork(names.length)} />;
}

/** The cells of a fork's address: the selected ones; or null for all of the generation shown. */
export function forkedCells(selected: CellSet, shown: Elites, trust: string): string | null {
  if (selected.size > 0) return formatCells(selected);
  return trust ? formatCells(shown.keys()) : null; // A verdict hides some of them.
}

interface Props extends Selection {
  run: Run;
  of: Of;
  elites: Elites;
  /** The generation shown; null for the newest. */
  at: number | null;
  /** The verdict of the elites shown; empty for all of them. */
  trust: string;
}

export function SelectionBar({ run, of, elites, at, trust, selected, onSelect }: Props) {
  if (!onSelect) return null;
  const cells = selected.size > 0 ? [...selected] : at === null ? [] : [...elites.keys()];
  const names = new Set(cells.map((cell) => elites.get(cell)!.creature));
  const creatures = names.size;
  const which = text.creatures(count(creatures), at === null ? null : count(at));
  return (
    <div class="row selection-bar">
      <span role="status">{selected.size > 0 && text.selected(which)}</span>
      {/* Outside the live region: it would be read at every step of the slider. */}
      {selected.size === 0 && creatures > 0 && <span>{which}</span>}
      {selected.size > 0 && creatures > 0 && (
        <BreedButton run={run} creatures={[...names]} onChosen={() => setSelection(new Set())} />
      )}
      {creatures > 0 && of === "elites" && (
        <ForkLink
          run={run.id}
          cells={forkedCells(selected, elites, trust)}
          at={at}
          title={text.fork(creatures)}
        />
      )}
      {creatures > 0 && of === "history" && <ForkByName run={run.id} names={[...names]} />}
      {selected.size > 1 && <SideBySide creatures={[...names]} title={text.sideBySide} />}
      {selected.size > 0 && <button onClick={() => setSelection(new Set())}>{text.clearSelection}</button>}
    </div>
  );
}
