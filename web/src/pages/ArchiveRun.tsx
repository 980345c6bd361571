/** A run that searches: its archive and its curves. */

import type { Axis, Run } from "../api/types";
import type { Detail } from "../live/detail";
import { navigate, setQuery } from "../router";
import { ArchiveMap } from "../view/archive/ArchiveMap";
import type { ColourBy } from "../view/archive/draw";
import { Curves } from "../view/Curves";
import { count } from "../view/format";

interface Props {
  run: Run;
  detail: Detail | undefined;
  query: URLSearchParams;
}

export function ArchiveRun({ run, detail, query }: Props) {
  return (
    <div class="run-columns">
      <ArchiveCard run={run} detail={detail} query={query} />
      <section class="card curves-card" aria-labelledby="curves-title">
        <h2 id="curves-title">Curves</h2>
        {detail?.curves && detail.curves.generation.length > 0 ? (
          <Curves curves={detail.curves} />
        ) : (
          <p class="quiet waiting">They begin with the first generation.</p>
        )}
      </section>
    </div>
  );
}

function ArchiveCard({ run, detail, query }: Props) {
  const colourBy: ColourBy = query.get("colour") === "generation" ? "generation" : "fitness";
  const cell = query.get("cell");
  const elites = detail?.elites;
  const open = (chosen: number) => {
    setQuery({ cell: String(chosen) });
    navigate(`/creatures/${elites!.get(chosen)!.creature}?run=${run.id}`);
  };
  return (
    <section class="card" aria-labelledby="archive-title">
      <div class="card-head">
        <h2 id="archive-title">Archive</h2>
        <span class="quiet">{detail?.archive && elites ? `${count(elites.size)} elites` : ""}</span>
        <span class="spring" />
        <label class="compact">
          Colour
          <select
            value={colourBy}
            onChange={({ currentTarget: { value } }) =>
              setQuery({ colour: value === "fitness" ? null : value })
            }
          >
            <option value="fitness">fitness</option>
            <option value="generation">generation</option>
          </select>
        </label>
      </div>
      {detail?.archive && elites ? (
        <ArchiveMap
          axes={detail.archive.axes as [Axis, Axis]}
          elites={elites}
          colourBy={colourBy}
          marked={cell === null ? null : Number(cell)}
          onMark={(marked) => setQuery({ cell: String(marked) })}
          onOpen={open}
        />
      ) : (
        <p class="quiet waiting">Loading the archive …</p>
      )}
    </section>
  );
}
