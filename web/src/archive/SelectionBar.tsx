/** Whom a new run could begin from: those who were chosen, or a generation of the past. */

import { useMemo } from "preact/hooks";
import { share } from "../api/address";
import type { Run } from "../api/types";
import { useRefusal } from "../store/principal";
import { among, written } from "../store/cellRanges";
import type { Elites } from "../store/elites";
import { setQuery } from "../store/router";
import { type Choosing, type Chosen, cellsIn, turned } from "./selection";
import type { Projection } from "./projection";
import { count } from "../ui/format";
import { ForkLink } from "../ui/ForkLink";

const choose = (chosen: Chosen) => setQuery({ cells: chosen.size > 0 ? written(chosen) : null });

/** The cells that the address names, as far as somebody lives in them. */
export function useChoosing(query: URLSearchParams, elites: Elites): Choosing {
  const text = query.get("cells") ?? "";
  const refusal = useRefusal();
  const chosen = useMemo(() => {
    const named = among(text);
    return new Set(text ? [...elites.keys()].filter(named) : []);
  }, [text, elites]);
  return { chosen, onChoose: share || refusal ? null : choose };
}

interface OneProps extends Choosing {
  cell: number;
  projection: Projection;
}

/** Where there is neither mouse nor key: chooses what is looked at, with all that stand there. */
export function ChooseOne({ cell, projection, chosen, onChoose }: OneProps) {
  const bin = projection.bins.get(cell);
  if (!onChoose || bin === undefined) return null;
  return (
    <button
      class="link"
      aria-pressed={chosen.has(cell)}
      onClick={() => onChoose(turned(chosen, cellsIn([bin], projection)))}
    >
      Choose
    </button>
  );
}

interface Props extends Choosing {
  run: Run;
  elites: Elites;
  /** A generation of the past; null for the newest. */
  at: number | null;
}

export function ChosenBar({ run, elites, at, chosen, onChoose }: Props) {
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
          cells={chosen.size > 0 ? written(chosen) : null}
          at={at}
          title={`A new run that begins from ${creatures === 1 ? "this creature" : "these creatures"}`}
        />
      )}
      {chosen.size > 0 && <button onClick={() => choose(new Set())}>Choose none</button>}
    </div>
  );
}
