/** The page of a sweep: summary, curves and all runs. */

import type { CaseSummary, Sweep } from "../api/types";
import { useRefusal } from "../store/principal";
import { useExperiments } from "../store/fetch";
import {
  type SweepDetail,
  cancelSweepWithUndo,
  removeSweep,
  renameSweep,
  restoreSweep,
  sendSweepCommand,
  useSweep,
} from "../store/sweeps";
import { setQuery } from "../store/router";
import { Curves } from "../charts/curves/Curves";
import { type ShownCase, summaryPlotsOf, caseName } from "./summaryPlots";
import { SweepProgress, SweepStates, sizeText, sweepTitle } from "./SweepStatus";
import { dateTime } from "../ui/format";
import { Card, NotFound, Page, useTitle } from "../ui/Page";
import { ConfirmButton } from "../ui/ConfirmButton";
import { NameField } from "../run/NameField";
import { MAX_LINES, colourOf, dashOf } from "../charts/lineStyle";
import { CurveBar, QueryCheck } from "../charts/curves/CurveOptions";
import { CaseCreatures, Cases, Finals, Members } from "./CaseTables";
import { lazy } from "../ui/lazy";
import { text } from "./text";

const StatisticsCard = lazy(
  async () => (await import("../statistics/StatisticsCard")).StatisticsCard,
  "section",
);

export function SweepPage({ id, query }: { id: string; query: URLSearchParams }) {
  const each = query.get("each") === "1";
  const { value, error } = useSweep(id, each);
  const title = value ? sweepTitle(value.sweep) : text.sweep;
  useTitle(title);
  return (
    <Page crumbs={[["/", text.runs]]} error={value && error} loading={!value && !error}>
      {error && !value && <NotFound what={text.noSuchSweep} reason={error} id={id} />}
      {value && <LoadedSweep {...{ value, query, each }} />}
    </Page>
  );
}

function LoadedSweep({ value, query, each }: { value: SweepDetail; query: URLSearchParams; each: boolean }) {
  const { sweep, summary, curves } = value;
  const selected = selectedCases(query, summary.cases.length);
  const cases = summary.cases.map(shownOf);
  const shown = selected.map((caseIndex) => cases[caseIndex]!);
  const choose = (indices: number[]) => setQuery({ cases: indices.length > 0 ? indices.join() : "-" });
  return (
    <>
      <Head sweep={sweep} />
      <section class="run-facts" aria-label={text.status}>
        <SweepProgress sweep={sweep} />
        <SweepStates sweep={sweep} />
      </section>
      <Card id="curves" kind="wide-curves" title={text.curves} note={text.curvesAbout}>
        <CurveBar log={query.get("log") === "1"}>
          <QueryCheck title={text.eachRun} name="each" on={each} />
        </CurveBar>
        {cases.length > 1 && <Cases cases={cases} selected={selected} onSelect={choose} />}
        <CaseCurves {...{ shown, query }} curves={each ? curves : null} />
      </Card>
      <CaseCreatures shown={shown} />
      <Finals cases={cases} generation={summary.generation} />
      {mayCompare(sweep) && (
        <StatisticsCard of={{ sweep: sweep.id }} corrected={hasCorrected(summary.cases)} />
      )}
      <Members cases={cases} />
    </>
  );
}

/** Statistics need archives of finished runs. */
function mayCompare({ spec, status_counts }: Sweep): boolean {
  const { queued = 0, running = 0, paused = 0, finished = 0 } = status_counts;
  return "search" in spec && finished > 0 && queued + running + paused === 0;
}

const hasCorrected = (cases: CaseSummary[]) => cases.every(({ finals }) => "corrected_qd_score" in finals);

const shownOf = (summary: CaseSummary, caseIndex: number): ShownCase => ({
  summary,
  caseIndex,
  name: caseName(summary.values),
  colour: colourOf(caseIndex),
  dash: dashOf(caseIndex),
});

/** The cases in the address, or the first ones. */
function selectedCases(query: URLSearchParams, count: number): number[] {
  const all = [...Array(count).keys()];
  const requested = query.get("cases");
  if (requested === null) return all.slice(0, MAX_LINES);
  const named = requested.split(",").map(Number);
  return all.filter((caseIndex) => named.includes(caseIndex));
}

interface CurvesProps {
  shown: ShownCase[];
  query: URLSearchParams;
  curves: SweepDetail["curves"];
}

function CaseCurves({ shown, query, curves }: CurvesProps) {
  const log = query.get("log") === "1";
  const plots = summaryPlotsOf(shown, curves);
  if (shown.length === 0) return <p class="quiet">{text.chooseCase}</p>;
  if (plots.length === 0) return <p class="quiet waiting">{text.noCurves}</p>;
  return <Curves plots={plots} view={{ over: "generation", log, smooth: 1 }} />;
}

function Head({ sweep }: { sweep: Sweep }) {
  const experiments = useExperiments().value ?? [];
  const title = sweepTitle(sweep);
  const readOnly = useRefusal(sweep) !== null || sweep.total === 0;
  const kind = experiments.find(({ experiment }) => experiment === sweep.experiment)?.title;
  return (
    <>
      <header class="page-head">
        <NameField of={sweep} {...{ title, readOnly }} onName={(name) => void renameSweep(sweep.id, name)}>
          <h1>{title}</h1>
        </NameField>
        <span class="spring" />
        <Actions sweep={sweep} title={title} />
      </header>
      <p class="quiet sweep-about">
        {kind ?? sweep.experiment} · {sizeText(sweep)} · {dateTime(sweep.created_at)}
        {sweep.owner && <> · {text.by(sweep.owner)}</>} · <a href={`/?sweep=${sweep.id}`}>{text.listRuns}</a>
      </p>
      {sweep.deleted > 0 && <BinNotice sweep={sweep} />}
    </>
  );
}

/** Buttons for the commands that the state of any run allows. */
function Actions({ sweep, title }: { sweep: Sweep; title: string }) {
  const { id, status_counts, total } = sweep;
  const refusal = useRefusal(sweep);
  if (refusal) return <span class="quiet small">{refusal}</span>;
  const { queued = 0, running = 0, paused = 0 } = status_counts;
  const active = queued + running;
  if (total === 0) return null;
  return (
    <span class="actions" role="group" aria-label={text.allRuns}>
      {paused > 0 && (
        <ConfirmButton
          verb={text.resumeAll}
          what={title}
          queues={text.resumes(paused)}
          onConfirm={() => sendSweepCommand(id, "resume")}
        />
      )}
      {active > 0 && <button onClick={() => void sendSweepCommand(id, "pause")}>{text.pauseAll}</button>}
      {active + paused > 0 && (
        <button class="danger" onClick={() => void cancelSweepWithUndo(id)}>
          {text.cancelAll}
        </button>
      )}
      {active === 0 && (
        <button class="danger" onClick={() => void removeSweep(id)}>
          {text.deleteAll}
        </button>
      )}
    </span>
  );
}

function BinNotice({ sweep }: { sweep: Sweep }) {
  const { id, deleted, total } = sweep;
  const refusal = useRefusal(sweep);
  return (
    <p class="banner warning" role="status">
      {text.inBin(deleted, total)}{" "}
      {!refusal && <button onClick={() => void restoreSweep(id)}>{text.restore}</button>}
    </p>
  );
}
