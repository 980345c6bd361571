/** A sweep of gaits: how far each swimmer comes at each viscosity, in each form. */

import { useMemo, useState } from "preact/hooks";
import type { ResultRow } from "../../api/types";
import { setQuery } from "../../store/router";
import { formOf } from "../../ui/coupling";
import { NotForceFree } from "../../ui/NotForceFree";
import { Plot, type Point } from "../../charts/plot/Plot";
import { formsOf, reynoldsAxis, sweepAxes, sweepLines } from "./gaits";
import { Segments } from "../../ui/Select";
import { MarkReplay, useLastMark } from "./MarkReplay";
import { type ResultsProps, TableCard, hrefOf, useTable } from "../results/resultsPage";
import { text } from "./text";
import "./gaits.css";

const REPLAYS = "beside";

export function GaitsRun({ run, query }: ResultsProps) {
  const { results, missing } = useTable(run);
  const forms = formsOf(run.spec);
  const wanted = query.get("form") ?? "";
  const asked = [...forms, REPLAYS].includes(wanted) ? wanted : forms[0]!;
  const shown = asked === REPLAYS ? forms : [asked];
  const rows = (results?.rows ?? []).filter((row) => shown.includes(String(row.form)));
  const [near, setNear] = useState<Point | null>(null);
  const settled = useLastMark(near);
  return (
    <>
      <section class="card plot-card" aria-labelledby="sweep-title">
        <div class="card-head">
          <h2 id="sweep-title">{text.title}</h2>
          <span class="spring" />
          {forms.length > 1 && <Forms forms={forms} chosen={asked} />}
        </div>
        {missing ? (
          <p class="quiet waiting">{missing}</p>
        ) : (
          <div class={shown.length > 1 ? "" : "with-replay"}>
            <div class={shown.length > 1 ? "beside" : ""}>
              {shown.map((form) => (
                <Sweep key={form} {...{ run, query, form }} all={results!.rows} onNear={setNear} />
              ))}
            </div>
            <MarkReplay point={settled} />
          </div>
        )}
        {rows.length > 0 && <Key rows={rows} />}
      </section>
      {rows.length > 0 && <TableCard run={run} query={query} rows={rows} />}
    </>
  );
}

function Forms({ forms, chosen }: { forms: string[]; chosen: string }) {
  const choices = forms.map((form): [string, string] => [form, formOf(form).title]);
  return (
    <Segments
      label={text.form}
      choices={[...choices, [REPLAYS, text.sideBySide]]}
      value={chosen}
      onChoose={(form) => setQuery({ form: form === forms[0] ? null : form })}
    />
  );
}

interface SweepProps extends ResultsProps {
  form: string;
  all: ResultRow[];
  onNear: (point: Point | null) => void;
}

function Sweep({ run, form, all, onNear }: SweepProps) {
  const rows = useMemo(() => all.filter((row) => row.form === form), [all, form]);
  // Marks stay the same while one of them is pointed at.
  const lines = useMemo(() => sweepLines(run.spec, rows, hrefOf(run)), [run.id, run.spec, rows]);
  const { title, about, free } = formOf(form);
  // Bodies that push themselves go many times as far: the others would lie along the axis.
  const peers = all.filter((row) => formOf(String(row.form)).free === free);
  return (
    <div class="sweep">
      <p class="sweep-title">
        <b>{title}</b> <span class="quiet">{about}</span> {!free && <NotForceFree />}
      </p>
      <Plot
        title={text.plot(title)}
        {...sweepAxes(run.spec, peers)}
        lines={lines}
        upper={reynoldsAxis(rows)}
        shaded={!free}
        onNear={onNear}
      />
    </div>
  );
}

/** What the marks say, as far as there are such. */
function Key({ rows }: { rows: ResultRow[] }) {
  const doubtful = rows.some((row) => row.status === "ok" && (row.limited || row.warnings));
  const failed = rows.some((row) => row.status !== "ok");
  return (
    <p class="quiet small marks">
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
