/** Results of gaits: the displacement of each swimmer at each viscosity, for each coupling. */

import { useMemo, useState } from "preact/hooks";
import type { ResultRow } from "../../api/types";
import { setQuery } from "../../store/router";
import { NotForceFree, couplingForm } from "../../ui/coupling";
import { type Point, Plot } from "../../charts/plot/Plot";
import { formsOf, reynoldsAxis, plotAxes, plotLines } from "./gaits";
import { Card } from "../../ui/Page";
import { Segments } from "../../ui/Select";
import { ReplayLoop } from "../../replay/ReplayLoop";
import { ReplayStatus, useReplays } from "../../replay/replays";
import { useDebounced } from "../../store/polling";
import { type ResultsProps, TableCard, hrefOf, useResultsTable } from "../results/ResultsTable";
import { text } from "./text";
import "./gaits.css";

/** Delay before a mark counts as chosen, so that a moving pointer requests no replays. */
const SETTLE_MS = 120;
/** In the address: all forms side by side. */
const ALL_FORMS = "all";

export function GaitsRun({ run, query }: ResultsProps) {
  const { results, missing } = useResultsTable(run);
  const forms = formsOf(run.spec);
  const requestedForm = query.get("form") ?? "";
  const selected = [...forms, ALL_FORMS].includes(requestedForm) ? requestedForm : forms[0]!;
  const shown = selected === ALL_FORMS ? forms : [selected];
  const rows = (results?.rows ?? []).filter((row) => shown.includes(String(row.form)));
  const [focused, setFocused] = useState<Point | null>(null);
  // The last mark under a resting pointer; leaving it keeps its replay.
  const [replayed, setReplayed] = useState<Point | null>(null);
  useDebounced(focused?.href ? focused : null, SETTLE_MS, setReplayed);
  return (
    <>
      <Card
        id="displacement"
        kind="plot-card"
        title={text.title}
        actions={forms.length > 1 && <Forms forms={forms} selected={selected} />}
      >
        {missing ? (
          <p class="quiet waiting">{missing}</p>
        ) : (
          <div class={shown.length > 1 ? "" : "with-replay"}>
            <div class={shown.length > 1 ? "beside" : ""}>
              {shown.map((form) => (
                <Chart key={form} {...{ run, query, form }} all={results!.rows} onFocusPoint={setFocused} />
              ))}
            </div>
            <aside class="mark-replay" aria-label={text.replay}>
              {replayed ? (
                <MarkPlayer key={replayed.href} point={replayed} />
              ) : (
                <p class="quiet small">{text.pointAtMark}</p>
              )}
            </aside>
          </div>
        )}
        {rows.length > 0 && <MarkLegend rows={rows} />}
      </Card>
      {rows.length > 0 && <TableCard run={run} query={query} rows={rows} />}
    </>
  );
}

function Forms({ forms, selected }: { forms: string[]; selected: string }) {
  const choices = forms.map((form): [string, string] => [form, couplingForm(form).title]);
  return (
    <Segments
      label={text.form}
      choices={[...choices, [ALL_FORMS, text.sideBySide]]}
      value={selected}
      onSelect={(form) => setQuery({ form: form === forms[0] ? null : form })}
    />
  );
}

interface ChartProps extends ResultsProps {
  form: string;
  all: ResultRow[];
  onFocusPoint: (point: Point | null) => void;
}

function Chart({ run, form, all, onFocusPoint }: ChartProps) {
  const rows = useMemo(() => all.filter((row) => row.form === form), [all, form]);
  // The marks must stay the same objects while the pointer is on one of them.
  const lines = useMemo(() => plotLines(run.spec, rows, hrefOf(run)), [run.id, run.spec, rows]);
  const { title, about, forceFree } = couplingForm(form);
  // Forms that are not force-free move bodies many times as far, so they have an axis of their own.
  const peers = all.filter((row) => couplingForm(String(row.form)).forceFree === forceFree);
  return (
    <div class="gait-plot">
      <p class="gait-plot-title row">
        <b>{title}</b> <span class="quiet">{about}</span> {!forceFree && <NotForceFree />}
      </p>
      <Plot
        title={text.plot(title)}
        {...plotAxes(run.spec, peers)}
        lines={lines}
        topAxis={reynoldsAxis(rows)}
        shaded={!forceFree}
        onFocusPoint={onFocusPoint}
      />
    </div>
  );
}

function MarkLegend({ rows }: { rows: ResultRow[] }) {
  const doubtful = rows.some((row) => row.status === "ok" && (row.limited || row.warnings));
  const failed = rows.some((row) => row.status !== "ok");
  return (
    <p class="quiet small marks row">
      <span>{text.marks}</span>
      {doubtful && (
        <span>
          <i class="mark-sample hollow" /> {text.doubtful}
        </span>
      )}
      {failed && (
        <span>
          <i class="mark-sample cross" /> {text.unfinished}
        </span>
      )}
    </p>
  );
}

function MarkPlayer({ point }: { point: Point }) {
  const rendering = useReplays([shaOf(point.href!)]);
  const replay = rendering.replays?.[0];
  const [name, ...figures] = point.tooltip;
  return (
    <>
      <ReplayStatus {...rendering} what={text.simulating} />
      {replay && <ReplayLoop replay={replay} name={text.swimming(name)} />}
      <p class="small">
        <b>{name}</b>
        <br />
        <span class="quiet">{figures.join(", ")}</span>
        <br />
        <a href={point.href}>{text.openCreature}</a>
      </p>
    </>
  );
}

const shaOf = (href: string) => href.split("/").at(-1)!.split("?")[0]!;
