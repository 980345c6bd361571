/** The curves of a search, with those of compared runs. */

import type { ComponentChildren } from "preact";
import { sharedSlug } from "../api/address";
import type { Choices, Run } from "../api/types";
import type { Curves as Columns } from "../store/curves";
import { hasArchive, useCurvesOf, useExperiments } from "../store/fetch";
import { useRuns } from "../store/store";
import { setQuery } from "../store/router";
import { Curves } from "../charts/curves/Curves";
import { type OtherRun, arrangePlots, curveViewOf, placesOf } from "../charts/curves/curveView";
import { REASONS, infeasibleBy, scoresOf, workOf } from "../charts/curves/plots";
import { count, percent, shortId, titleOf, words } from "../ui/format";
import { CurveOptions } from "../charts/curves/CurveOptions";
import { Card } from "../ui/Page";
import { RunPicker } from "./RunPicker";
import { text } from "./text";

/** More lines cannot be distinguished. */
const MAX_COMPARED = 4;

interface Props {
  run: Run;
  curves: Columns | null;
  query: URLSearchParams;
  compared: ComparedRuns;
}

interface CurvesProps extends Props {
  /** Creatures chosen to breed, if any: plots mark their generations. */
  chosen: Choices | null;
}

interface ComparedRuns {
  ids: string[];
  others: OtherRun[];
  error: string | null;
}

export function CurvesCard({ run, curves, query, compared: { ids, others, error }, chosen }: CurvesProps) {
  const view = curveViewOf(query);
  const marks = curves && chosen ? placesOf(generationsOf(chosen), curves, view) : [];
  return (
    <Card id="curves" kind="curves-card" title={text.curves}>
      {curves && <CurveOptions view={view} />}
      {curves && !sharedSlug && <ComparedList {...{ run, ids, others }} />}
      {error && <p class="wrong-text small">{error}</p>}
      {curves ? (
        <Curves plots={arrangePlots(scoresOf, curves, others, view)} view={view} marks={marks} />
      ) : (
        <p class="quiet waiting">{text.noCurves}</p>
      )}
      {marks.length > 0 && <p class="quiet small">{text.chosenMarks}</p>}
    </Card>
  );
}

const generationsOf = ({ items }: Choices) => items.flatMap(({ generation }) => generation ?? []);

export function SearchCard({ run, curves, query, compared }: Props & { curves: Columns }) {
  const view = curveViewOf(query);
  const plots = arrangePlots(workOf, curves, compared.others, view);
  if (plots.length === 0 && run.infeasible === 0) return null;
  return (
    <Card id="search" kind="wide-curves" title={text.search}>
      <Curves plots={plots} view={view} />
      <InfeasibleTable run={run} reasons={infeasibleBy(curves)} />
    </Card>
  );
}

function InfeasibleTable({ run, reasons }: { run: Run; reasons: [reason: string, count: number][] }) {
  const known = reasons.reduce((sum, [, number]) => sum + number, 0);
  const unknown = run.infeasible - known;
  if (run.infeasible === 0) return <p class="quiet small">{text.noneInfeasible}</p>;
  const rows = reasons.map(([reason, number]) => [words(reason), number, REASONS[reason] ?? ""] as const);
  if (unknown > 0) rows.push([text.unknown, unknown, text.reasonMissing]);
  return (
    <table class="plain-table infeasible">
      <caption>{text.infeasibleCaption}</caption>
      <tbody>
        {rows.map(([name, number, about]) => (
          <tr key={name}>
            <th scope="row">{name}</th>
            <td class="figure">{count(number)}</td>
            <td class="figure quiet">{percent(number / Math.max(1, run.evaluations))}</td>
            <td class="quiet">{about}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

/** The runs to compare from the address, without duplicates and the run itself. */
export function useComparedRuns(query: URLSearchParams, id: string): ComparedRuns {
  const requested = (query.get("with") ?? "").split(",").filter((other) => other && other !== id);
  const ids = [...new Set(requested)].slice(0, MAX_COMPARED);
  const { value, error } = useCurvesOf(ids);
  const runs = useRuns(ids);
  const experiments = useExperiments().value ?? [];
  const others = ids.flatMap((id, i): OtherRun[] => {
    const [curves, run] = [value?.get(id), runs[i]];
    if (!curves || !run || curves.generation.length === 0) return [];
    const name = `${titleOf(run, experiments)} ${shortId(id)}`;
    return [{ name, colour: `--series-${2 + i}`, curves }];
  });
  return { ids, others, error };
}

function ComparedList({ run, ids, others }: { run: Run; ids: string[]; others: OtherRun[] }) {
  const set = (next: string[]) => setQuery({ with: next.length > 0 ? next.join() : null });
  const without = (id: string) => set(ids.filter((other) => other !== id));
  const nameOf = (id: string) => others.find(({ name }) => name.endsWith(shortId(id)))?.name ?? shortId(id);
  return (
    <div class="row beside-runs" role="group" aria-label={text.comparedRuns}>
      {ids.length > 0 && <Chip colour="--series-1">{text.thisRun}</Chip>}
      {ids.map((id, i) => (
        <Chip key={id} colour={`--series-${2 + i}`}>
          <a href={`/runs/${id}`}>{nameOf(id)}</a>
          <button class="plain" aria-label={text.remove(nameOf(id))} onClick={() => without(id)}>
            ✕
          </button>
        </Chip>
      ))}
      {ids.length < MAX_COMPARED && (
        <RunPicker
          run={run}
          label={text.compareWith}
          fits={(other) => hasArchive(other) && other.generation > 0 && !ids.includes(other.id)}
          onSelect={(id) => set([...ids, id])}
        />
      )}
    </div>
  );
}

function Chip({ colour, children }: { colour: string; children: ComponentChildren }) {
  return (
    <span class="chip">
      <i style={{ background: `var(${colour})` }} />
      {children}
    </span>
  );
}
