/** Whom a new run could begin from: those who were chosen, or a generation of the past. */

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

const setSelection = (chosen: CellSet) => setQuery({ cells: chosen.size > 0 ? formatCells(chosen) : null });

/** The cells that the address names, as far as somebody lives in them. */
export function useSelection(query: URLSearchParams, elites: Elites): Selection {
  const text = query.get("cells") ?? "";
  const refusal = useRefusal();
  const chosen = useMemo(() => {
    const named = parseCells(text);
    return new Set(text ? [...elites.keys()].filter(named) : []);
  }, [text, elites]);
  return { chosen, onChoose: sharedSlug || refusal ? null : setSelection };
}

interface OneProps extends Selection {
  cell: number;
  projection: Projection;
}

/** Where there is neither mouse nor key: chooses what is looked at, with all that stand there. */
export function SelectToggle({ cell, projection, chosen, onChoose }: OneProps) {
  const bin = projection.bins.get(cell);
  if (!onChoose || bin === undefined) return null;
  return (
    <button
      class="link"
      aria-pressed={chosen.has(cell)}
      onClick={() => onChoose(toggle(chosen, cellsIn([bin], projection)))}
    >
      Choose
    </button>
  );
}

interface Props extends Selection {
  run: Run;
  elites: Elites;
  /** A generation of the past; null for the newest. */
  at: number | null;
}

export function SelectionBar({ run, elites, at, chosen, onChoose }: Props) {
  if (!onChoose) return null;
  const then = at === null ? "" : ` of generation ${count(at)}`;
  const cells = chosen.size > 0 ? [...chosen] : at === null ? [] : [...elites.keys()];
  const creatures = new Set(cells.map((cell) => elites.get(cell)!.creature)).size;
  const text = `${count(creatures)} ${creatures === 1 ? "creature" : "creatures"}${then}`;
  return (
    <div class="chosen-bar">
      <span role="status">{chosen.size > 0 && `${text} chosen`}</span>
      {/* Not said with every step of the slider. */}
      {chosen.size === 0 && creatures > 0 && <span>{text}</span>}
      {creatures > 0 && (
        <ForkLink
          run={run.id}
          cells={chosen.size > 0 ? formatCells(chosen) : null}
          at={at}
          title={`A new run that begins from ${creatures === 1 ? "this creature" : "these creatures"}`}
        />
      )}
      {chosen.size > 0 && <button onClick={() => setSelection(new Set())}>Choose none</button>}
    </div>
  );
}
