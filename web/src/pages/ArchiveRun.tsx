/** A run that searches: its archive, how good it is, and what the search is doing. */

import { useMemo } from "preact/hooks";
import type { Archive, Run } from "../api/types";
import type { Detail } from "../live/detail";
import type { Elites } from "../live/elites";
import { useFeatures } from "../live/fetching";
import { navigate, setQuery } from "../router";
import { ArchiveMap } from "../view/archive/ArchiveMap";
import { AxisChoice } from "../view/archive/AxisChoice";
import { axisOf, missingOf, namesOf } from "../view/archive/axes";
import type { ColourBy } from "../view/archive/draw";
import { Curves } from "../view/curves/Curves";
import { scoresOf, workOf } from "../view/curves/plots";
import { count } from "../view/format";

interface Props {
  run: Run;
  detail: Detail | undefined;
  query: URLSearchParams;
}

export function ArchiveRun({ run, detail, query }: Props) {
  const curves = detail?.curves && detail.curves.generation.length > 0 ? detail.curves : null;
  const work = curves ? workOf(curves) : [];
  return (
    <>
      <div class="run-columns">
        <section class="card" aria-labelledby="archive-title">
          {detail?.archive ? (
            <ArchiveCard run={run} archive={detail.archive} elites={detail.elites} query={query} />
          ) : (
            <>
              <h2 id="archive-title">Archive</h2>
              <p class="quiet waiting">Loading the archive …</p>
            </>
          )}
        </section>
        <section class="card curves-card" aria-labelledby="curves-title">
          <h2 id="curves-title">Curves</h2>
          {curves ? (
            <Curves plots={scoresOf(curves)} generation={curves.generation} />
          ) : (
            <p class="quiet waiting">They begin with the first generation.</p>
          )}
        </section>
      </div>
      {curves && work.length > 0 && (
        <section class="card work-card" aria-labelledby="work-title">
          <h2 id="work-title">Search, generation by generation</h2>
          <Curves plots={work} generation={curves.generation} />
        </section>
      )}
    </>
  );
}

interface CardProps {
  run: Run;
  archive: Archive;
  elites: Elites;
  query: URLSearchParams;
}

function ArchiveCard({ run, archive, elites, query }: CardProps) {
  const colourBy: ColourBy = query.get("colour") === "generation" ? "generation" : "fitness";
  const cell = query.get("cell");
  const [x, y] = namesOf(archive, query.get("x"), query.get("y"));
  const features = useFeatures(run.id, missingOf(archive, [x, y]), elites);
  const axes = useMemo(() => {
    const axis = (name: string) => axisOf(name, archive, elites, features);
    return [axis(x), axis(y)] as const;
  }, [x, y, archive, elites, features]);
  const open = (chosen: number) => {
    setQuery({ cell: String(chosen) });
    navigate(`/creatures/${elites.get(chosen)!.creature}?run=${run.id}`);
  };
  return (
    <>
      <div class="card-head">
        <h2 id="archive-title">Archive</h2>
        <span class="quiet">{count(elites.size)} elites</span>
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
      <AxisChoice archive={archive} names={[x, y]} onChoose={([x, y]) => setQuery({ x, y })} />
      <ArchiveMap
        key={`${x} ${y}`}
        axes={axes}
        elites={elites}
        colourBy={colourBy}
        marked={cell === null ? null : Number(cell)}
        onMark={(marked) => setQuery({ cell: String(marked) })}
        onOpen={open}
      />
    </>
  );
}
