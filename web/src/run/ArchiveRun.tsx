/** A run with an archive: map, curves and search. */

import type { Run } from "../api/types";
import type { Detail } from "../store/detail";
import { useChoices } from "../store/choices";
import { nameOf } from "../store/figureNames";
import { lazy } from "../ui/lazy";
import { ArchiveCard } from "../archive/ArchiveCard";
import { CurvesCard, SearchCard, useComparedRuns } from "./RunCurves";
import { text } from "./text";
import "./run.css";

const ChoicesCard = lazy(async () => (await import("../breeding/ChoicesCard")).ChoicesCard, "section");

interface Props {
  run: Run;
  detail: Detail | undefined;
  query: URLSearchParams;
}

export function ArchiveRun({ run, detail, query }: Props) {
  const curves = detail?.curves && detail.curves.generation.length > 0 ? detail.curves : null;
  const compared = useComparedRuns(query, run.id);
  const choices = useChoices(run);
  const chosen = choices && choices.items.length > 0 ? choices : null;
  return (
    <>
      <div class={`run-columns ${query.get("view") === "gallery" ? "wide" : ""}`}>
        <section class="card archive-card" id="archive" aria-labelledby="archive-title" tabIndex={-1}>
          {detail?.archive ? (
            <ArchiveCard run={run} archive={detail.archive} elites={detail.elites} query={query} />
          ) : (
            <>
              <h2 id="archive-title">{text.archive}</h2>
              <p class="quiet waiting tall">{text.loadingArchive}</p>
            </>
          )}
        </section>
        <CurvesCard {...{ run, curves, query, compared, chosen }} />
      </div>
      {chosen && (
        <ChoicesCard
          {...{ run, choices: chosen }}
          children={curves?.summary[nameOf("emitter.*.children", "chosen")]?.at(-1) ?? null}
        />
      )}
      {curves && <SearchCard {...{ run, curves, query, compared }} />}
    </>
  );
}
