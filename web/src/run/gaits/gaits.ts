/** Displacement against viscosity as lines, one per swimmer. */

import type { ResultRow, Spec } from "../../api/types";
import { number, percent, words } from "../../ui/format";
import type { TopAxis } from "../../charts/plot/Frame";
import type { Axis, Line, Point } from "../../charts/plot/Plot";
import { fromZero, logAround } from "../../charts/plot/scale";
import { text } from "./text";

/** In the order of the paper, so that each swimmer has the same colour in every run. */
const SWIMMERS = ["worm", "tadpole", "ray", "cilia", "jellyfish"];

type Href = (creature: string) => string;

const strings = (value: unknown) => (Array.isArray(value) ? value.map(String) : []);
const measure = (row: ResultRow, name: string) =>
  typeof row[name] === "number" ? (row[name] as number) : null;

export const formsOf = (spec: Spec) => strings(spec.forms);

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
  const warnings = String(row.warnings ?? "")
    .split("; ")
    .filter(Boolean);
  if (warnings.length > 0 || !doubtful(row)) return warnings;
  return [text.limited(percent(Number(row.limited)))];
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
