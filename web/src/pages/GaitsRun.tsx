/** A sweep of gaits: how far each swimmer comes at each viscosity, in each form. */

import type { ResultRow } from "../api/types";
import { setQuery } from "../router";
import { formOf } from "../view/coupling";
import { NotFree } from "../view/NotFree";
import { Plot } from "../view/plot/Plot";
import { formsOf, reynoldsAxis, sweepAxes, sweepLines } from "../view/results/gaits";
import { type Props, TableCard, hrefOf, useTable } from "./results";

const BESIDE = "beside";

export function GaitsRun({ run, query }: Props) {
  const { results, missing } = useTable(run);
  const forms = formsOf(run.spec);
  const wanted = query.get("form") ?? "";
  const asked = [...forms, BESIDE].includes(wanted) ? wanted : forms[0]!;
  const shown = asked === BESIDE ? forms : [asked];
  const rows = (results?.rows ?? []).filter((row) => shown.includes(String(row.form)));
  return (
    <>
      <section class="card plot-card" aria-labelledby="sweep-title">
        <div class="card-head">
          <h2 id="sweep-title">Displacement against viscosity</h2>
          <span class="spring" />
          {forms.length > 1 && <Forms forms={forms} chosen={asked} />}
        </div>
        {missing ? (
          <p class="quiet waiting">{missing}</p>
        ) : (
          <div class={shown.length > 1 ? "beside" : ""}>
            {shown.map((form) => (
              <Sweep key={form} {...{ run, query, form }} all={results!.rows} />
            ))}
          </div>
        )}
        {rows.length > 0 && <Key rows={rows} />}
      </section>
      {rows.length > 0 && <TableCard run={run} query={query} rows={rows} />}
    </>
  );
}

function Forms({ forms, chosen }: { forms: string[]; chosen: string }) {
  const choices = [...forms.map((form) => [form, formOf(form).title]), [BESIDE, "Side by side"]];
  return (
    <div class="tabs" role="group" aria-label="Form of the coupling">
      {choices.map(([form, title]) => (
        <button
          key={form}
          type="button"
          aria-pressed={form === chosen}
          onClick={() => setQuery({ form: form === forms[0] ? null : form! })}
        >
          {title}
        </button>
      ))}
    </div>
  );
}

function Sweep({ run, form, all }: Props & { form: string; all: ResultRow[] }) {
  const rows = all.filter((row) => row.form === form);
  const { title, about, free } = formOf(form);
  // Bodies that push themselves go many times as far: the others would lie along the axis.
  const peers = all.filter((row) => formOf(String(row.form)).free === free);
  return (
    <div class="sweep">
      <p class="sweep-title">
        <b>{title}</b> <span class="quiet">{about}</span> {!free && <NotFree />}
      </p>
      <Plot
        title={`Displacement against viscosity, ${title}`}
        {...sweepAxes(run.spec, peers)}
        lines={sweepLines(run.spec, rows, hrefOf(run))}
        upper={reynoldsAxis(rows)}
        shaded={!free}
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
      <span>Each mark leads to the creature’s replay.</span>
      {doubtful && (
        <span>
          <i class="mark-sample hollow" /> with a warning, or limits were active
        </span>
      )}
      {failed && (
        <span>
          <i class="mark-sample cross" /> did not finish
        </span>
      )}
    </p>
  );
}
