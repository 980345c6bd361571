/** The creatures a new run can start from: the selected ones, or a past generation. */

import { useMemo } from "preact/hooks";
import { sharedSlug } from "../api/address";
import type { Run } from "../api/types";
import { useRefusal } from "../store/principal";
import { parseCells, formatCells } from "../store/cellRanges";
import type { Elites } from "../store/elites";
import { setQuery } from "../store/router";
import { type Selection, type CellSet, cellsIn, toggle } from "./selection";
import type { Projection } from "./projection";
import { count } from "../ui/format";
import { ForkLink } from "../ui/ForkLink";
import { text } from "./text";

const setSelection = (chosen: CellSet) => setQuery({ cells: chosen.size > 0 ? formatCells(chosen) : null });

/** The cells in the address that have an elite. */
export function useSelection(query: URLSearchParams, elites: Elites): Selection {
  const cells = query.get("cells") ?? "";
  const refusal = useRefusal();
  const chosen = useMemo(() => {
    const named = parseCells(cells);
    return new Set(cells ? [...elites.keys()].filter(named) : []);
  }, [cells, elites]);
  return { chosen, onChoose: sharedSlug || refusal ? null : setSelection };
}

interface OneProps extends Selection {
  cell: number;
  projection: Projection;
}

/** Select or deselect the focused elite, for touch screens. */
export function SelectToggle({ cell, projection, chosen, onChoose }: OneProps) {
  const bin = projection.bins.get(cell);
  if (!onChoose || bin === undefined) return null;
  return (
    <button
      class="link"
      aria-pressed={chosen.has(cell)}
      onClick={() => onChoose(toggle(chosen, cellsIn([bin], projection)))}
    >
      {text.select}
    </button>
  );
}

interface Props extends Selection {
  run: Run;
  elites: Elites;
  /** The generation shown; null for the newest. */
  at: number | null;
}

export function SelectionBar({ run, elites, at, chosen, onChoose }: Props) {
  if (!onChoose) return null;
  const cells = chosen.size > 0 ? [...chosen] : at === null ? [] : [...elites.keys()];
  const creatures = new Set(cells.map((cell) => elites.get(cell)!.creature)).size;
  const which = text.creatures(count(creatures), at === null ? null : count(at));
  return (
    <div class="row chosen-bar">
      <span role="status">{chosen.size > 0 && text.selected(which)}</span>
      {/* Outside the live region: it would be read at every step of the slider. */}
      {chosen.size === 0 && creatures > 0 && <span>{which}</span>}
      {creatures > 0 && (
        <ForkLink
          run={run.id}
          cells={chosen.size > 0 ? formatCells(chosen) : null}
          at={at}
          title={text.fork(creatures)}
        />
      )}
      {chosen.size > 0 && <button onClick={() => setSelection(new Set())}>{text.clearSelection}</button>}
    </div>
  );
}
