/** Results of gaits: the displacement of each swimmer against viscosity, for each coupling. */

import { useMemo, useState } from "preact/hooks";
import type { ResultRow, Spec } from "../../api/types";
import { setQuery } from "../../store/router";
import { NotForceFree, couplingForm } from "../../ui/coupling";
import { type Point, type Axis, type Line, Plot } from "../../charts/plot/Plot";
import { Card } from "../../ui/Page";
import { Segments } from "../../ui/Select";
import { LoopPlayer } from "../../replay/LoopPlayer";
import { ReplayStatus, useReplays } from "../../replay/replays";
import { useDebounced } from "../../store/polling";
import { type ResultsProps, TableCard, hrefOf, useResultsTable } from "../results/ResultsTable";
import { text } from "./text";
import "./gaits.css";
import { number, percent, words } from "../../ui/format";
import type { TopAxis } from "../../charts/plot/Frame";
import { fromZero, logAround } from "../../charts/plot/scale";

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
      {replay && <LoopPlayer replay={replay} bare={text.swimming(name)} />}
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

/** In the order of the paper, so that each swimmer has the same colour in every run. */
const SWIMMERS = ["worm", "tadpole", "ray", "cilia", "jellyfish"];

type Href = (creature: string) => string;

const strings = (value: unknown) => (Array.isArray(value) ? value.map(String) : []);
const measure = (row: ResultRow, name: string) =>
  typeof row[name] === "number" ? (row[name] as number) : null;

const formsOf = (spec: Spec) => strings(spec.forms);

/** Common axes of several forms make them comparable. */
export function plotAxes(spec: Spec, rows: readonly ResultRow[]): { x: Axis; y: Axis } {
  const displacements = rows.filter(finished).map((row) => Number(row.displacement));
  const format = (value: number) => number(value, 2);
  return {
    x: { title: text.viscosity, scale: logAround(strings(spec.viscosities).map(Number)), format },
    y: { title: text.displacement, scale: fromZero(displacements), format },
  };
}

export function plotLines(spec: Spec, rows: readonly ResultRow[], hrefOf: Href): Line[] {
  return strings(spec.swimmers).map((swimmer) => ({
    name: swimmer,
    colour: `--series-${1 + Math.max(0, SWIMMERS.indexOf(swimmer))}`,
    points: rows
      .filter((row) => row.swimmer === swimmer)
      .map((row) => pointOf(row, hrefOf))
      .sort((a, b) => a.x - b.x),
  }));
}

/** True if the simulation completed, so that its figures count. */
const finished = (row: ResultRow) => row.status === "ok" && measure(row, "displacement") !== null;

/** True if warnings or active limits make a point doubtful. */
const doubtful = (row: ResultRow) => Number(row.limited) > 0 || Boolean(row.warnings);

function warningsOf(row: ResultRow): string[] {
  if (row.warnings) return [String(row.warnings)];
  return doubtful(row) ? [text.limited(percent(Number(row.limited)))] : [];
}

function pointOf(row: ResultRow, hrefOf: Href): Point {
  const displacement = finished(row) ? measure(row, "displacement") : null;
  const figures = [
    displacement === null ? words(String(row.status)) : text.cellsPerCycle(number(displacement)),
    text.reynolds(number(measure(row, "reynolds"))),
    ...warningsOf(row),
  ];
  return {
    x: Number(row.viscosity),
    y: displacement,
    hollow: doubtful(row),
    ...(row.creature && { href: hrefOf(row.creature) }),
    tooltip: [text.mark(words(String(row.swimmer)), number(Number(row.viscosity))), ...figures],
  };
}

/** The Reynolds numbers of the first swimmer that completed, above its viscosities. */
export function reynoldsAxis(rows: readonly ResultRow[]): TopAxis | null {
  const known = rows.filter((row) => finished(row) && Number(row.reynolds) > 0);
  const swimmer = SWIMMERS.find((name) => known.some((row) => row.swimmer === name));
  if (!swimmer) return null;
  const ofSwimmer = known.filter((row) => row.swimmer === swimmer);
  const ticks = ofSwimmer
    .map((row) => ({ at: Number(row.viscosity), text: number(Number(row.reynolds), 2) }))
    .sort((a, b) => a.at - b.at);
  return { title: text.reynoldsOf(swimmer), ticks };
}
