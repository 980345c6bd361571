/** The spec of a run: as sections with their differences from a preset, as JSON, and compared with another run. */

import { useMemo } from "preact/hooks";
import * as api from "../../api/client";
import type { Json, Preset, Run, Spec } from "../../api/types";
import { useExperiments, useFetched } from "../../store/fetch";
import { useStore } from "../../store/store";
import { setQuery } from "../../store/router";
import { shortId, titleOf, words } from "../../ui/format";
import { Card } from "../../ui/Page";
import { type Column, Table } from "../../ui/Table";
import { type Difference, differences, valueText } from "./difference";
import { copyText } from "../../ui/clipboard";
import { RunPicker } from "../RunPicker";
import { text } from "./text";
import "./spec.css";

export function SpecCard({ run, query }: { run: Run; query: URLSearchParams }) {
  const against = query.get("against");
  const json = useMemo(() => JSON.stringify(run.spec, null, 2), [run.spec]);
  const href = `data:application/json;charset=utf-8,${encodeURIComponent(json)}`;
  const actions = (
    <>
      <RunPicker
        run={run}
        label={text.compareSpec}
        fits={() => true}
        onSelect={(id) => setQuery({ against: id })}
      />
      <button class="slim" onClick={() => copyText(json, text.copied)}>
        {text.copyJson}
      </button>
      <a class="button slim" href={href} download={`${shortId(run.id)}-spec.json`}>
        spec.json
      </a>
    </>
  );
  return (
    <Card id="spec" kind="spec-card" title={text.spec} actions={actions}>
      {against && <DifferenceTo key={against} run={run} id={against} />}
      <Sections run={run} />
      <details>
        <summary>{text.json}</summary>
        <pre tabIndex={0}>{json}</pre>
      </details>
    </Card>
  );
}

function Sections({ run }: { run: Run }) {
  const experiments = useExperiments().value;
  const { nearest, sections } = useMemo(() => {
    const own = experiments?.find(({ experiment }) => experiment === run.experiment);
    const nearest = nearestPreset(run.spec, own?.presets ?? []);
    return { nearest, sections: sectionsOf(run.spec, nearest?.changed ?? []) };
  }, [experiments, run.spec]);
  return (
    <>
      {nearest && (
        <p class="quiet small">{text.changes(nearest.changed.length, words(nearest.preset.name))}</p>
      )}
      <div class="spec-sections">
        {sections.map(({ title, fields }) => (
          <details key={title} open={fields.some(({ presetValue }) => presetValue !== null)}>
            <summary>
              {title} <span class="quiet small">{fields.length}</span>
            </summary>
            <dl>
              {fields.map(({ path, name, text: value, presetValue }) => (
                <div key={path} class={presetValue === null ? "" : "changed-field"} title={path}>
                  <dt class="quiet">{name}</dt>
                  <dd>
                    {value}
                    {presetValue !== null && (
                      <span class="quiet small">
                        {" "}
                        {text.preset} {presetValue}
                      </span>
                    )}
                  </dd>
                </div>
              ))}
            </dl>
          </details>
        ))}
      </div>
    </>
  );
}

const COLUMNS: Column<Difference>[] = [
  { title: text.field, cell: ({ path }) => <span title={path}>{nameOf(path.split("."))}</span> },
  { title: text.thisRun, cell: ({ values }) => brief(values[0]) },
  { title: text.otherRun, cell: ({ values }) => brief(values[1]) },
];

function DifferenceTo({ run, id }: { run: Run; id: string }) {
  const known = useStore((state) => state.runs.get(id));
  const { value, error } = useFetched(() => api.readRun(id), [id]);
  const experiments = useExperiments().value ?? [];
  const other = known ?? value;
  const rows = useMemo(() => (other ? differences([run.spec, other.spec]) : []), [other?.spec, run.spec]);
  const close = () => setQuery({ against: null });
  return (
    <div class="spec-difference">
      {error && !other && <p class="wrong-text small">{error}</p>}
      {!other && !error && <p class="quiet">{text.loading}</p>}
      {other && (
        <>
          <p class="quiet">
            {rows.length === 0 ? text.noDifference : text.differences(rows.length)}
            <a href={`/runs/${id}`}>
              {titleOf(other, experiments)} <code>{shortId(id)}</code>
            </a>
          </p>
          {rows.length > 0 && (
            <Table label={text.difference} columns={COLUMNS} rows={rows} keyOf={({ path }) => path} />
          )}
        </>
      )}
      <button class="slim" onClick={close}>
        {text.close}
      </button>
    </div>
  );
}

/** Characters of a value that are shown; pictures have thousands. */
const MAX_LENGTH = 120;

interface Field {
  path: string;
  name: string;
  text: string;
  /** The value of the preset; null if it is the same. */
  presetValue: string | null;
}

/** The preset with the fewest differences from a spec, whatever the seed. */
export function nearestPreset(spec: Spec, presets: readonly Preset[]) {
  const seedless = (other: Spec) => ({ ...other, seed: spec.seed ?? null });
  const found = presets.map((preset) => ({
    preset,
    changed: differences([seedless(preset.spec), { seed: null, ...spec }]),
  }));
  return found.sort((a, b) => a.changed.length - b.changed.length)[0] ?? null;
}

/** One section for each part of the spec; fields that are no part come first. */
export function sectionsOf(spec: Spec, changed: readonly Difference[]) {
  const presetValue = new Map(changed.map(({ path, values }) => [path, values[0]]));
  const sections = new Map<string, Field[]>([["", []]]);
  for (const { path, values } of differences([{}, spec])) {
    const [head, ...rest] = path.split(".");
    const title = rest.length > 0 ? head! : "";
    if (!sections.has(title)) sections.set(title, []);
    sections.get(title)!.push({
      path,
      name: nameOf(rest.length > 0 ? rest : [head!]),
      text: brief(values[1]),
      presetValue: presetValue.has(path) ? brief(presetValue.get(path)) : null,
    });
  }
  return [...sections]
    .filter(([, fields]) => fields.length > 0)
    .map(([title, fields]) => ({ title: title ? words(title) : text.run, fields }));
}

/** `descriptors.0.bins` as `Descriptors 1, bins`. */
export function nameOf(parts: readonly string[]): string {
  const text = parts.map((part) => (/^\d+$/.test(part) ? ` ${Number(part) + 1}` : `, ${part}`)).join("");
  return words(text.replace(/^, /, "").trim());
}

export function brief(value: Json | undefined): string {
  const text = valueText(value);
  return text.length > MAX_LENGTH ? `${text.slice(0, MAX_LENGTH)} …` : text;
}
