/** Seeds and a grid of field values for several runs. */

import type { FieldError, Json } from "../api/types";
import { number } from "../ui/format";
import { valueAt } from "./form/document";
import type { Leaf } from "./form/fields";
import { nameOf } from "./sweepGrid";
import { type SweepForm, isSweep, complaintsOf } from "./sweep";
import { text } from "./text";
import "./sweep.css";

interface Props {
  sweeping: SweepForm;
  errors: readonly FieldError[];
  spec: Json;
}

export function SweepCard({ sweeping, errors, spec }: Props) {
  const { axes, fields, problems, total, change } = sweeping;
  const add = () => {
    const free = fields.find(({ path }) => !axes.some((axis) => axis.path === path));
    const usual = fields.find(({ path }) => path === "world.viscosity") ?? free;
    const next = axes.some(({ path }) => path === usual?.path) ? free : usual;
    if (next) change({ axes: [...axes, { path: next.path, text: textOf(valueAt(spec, next.path)) }] });
  };
  return (
    <section class="card sweep-card" aria-labelledby="sweep-title">
      <h2 id="sweep-title">{text.sweep}</h2>
      <p class="help">{text.sweepAbout}</p>
      <Entries sweeping={sweeping} />
      <Wrong said={[problems.seeds, ...complaintsOf(errors, "seeds")]} />
      {axes.map((axis, i) => (
        <Row
          key={i}
          fields={fields}
          path={axis.path}
          text={axis.text}
          said={[problems.axes[i] ?? null, ...complaintsOf(errors, `grid.${axis.path}`)]}
          taken={axes.map(({ path }) => path)}
          onChange={(next) => change({ axes: axes.with(i, next) })}
          onRemove={() => change({ axes: axes.toSpliced(i, 1) })}
        />
      ))}
      <Wrong said={[problems.total, ...complaintsOf(errors, "grid")]} />
      <p class="sweep-foot">
        <button type="button" onClick={add} disabled={axes.length >= fields.length}>
          {text.addAxis(axes.length === 0)}
        </button>
        {isSweep(sweeping) && (
          <span role="status" class="quiet">
            {text.totalRuns(total)}
          </span>
        )}
      </p>
    </section>
  );
}

/** How many seeds, and what the sweep is called. */
function Entries({ sweeping }: { sweeping: SweepForm }) {
  const { seeded, seeds, name, problems, change } = sweeping;
  return (
    <div class="sweep-entries">
      {seeded && (
        <label class="sweep-seeds">
          <span>{text.seeds}</span>
          <input
            type="text"
            inputMode="numeric"
            value={seeds}
            aria-invalid={problems.seeds !== null}
            onInput={(event) => change({ seeds: event.currentTarget.value })}
          />
        </label>
      )}
      {isSweep(sweeping) && (
        <label class="sweep-name-field">
          <span>{text.sweepName}</span>
          <input
            type="text"
            maxLength={200}
            value={name}
            placeholder={text.optional}
            onInput={(event) => change({ name: event.currentTarget.value })}
          />
        </label>
      )}
    </div>
  );
}

export function goToSweep(): void {
  const card = document.querySelector(".sweep-card");
  card?.scrollIntoView({ block: "center" });
  card?.querySelector<HTMLElement>("input, button")?.focus({ preventScroll: true });
}

const textOf = (value: Json): string =>
  value === null || typeof value === "object" ? "" : typeof value === "number" ? plain(value) : String(value);

/** A number as one types it. */
const plain = (value: number) => (Math.abs(value) >= 1e-4 ? String(value) : number(value, 6));

interface RowProps {
  fields: readonly Leaf[];
  path: string;
  text: string;
  said: (string | null)[];
  taken: string[];
  onChange: (axis: { path: string; text: string }) => void;
  onRemove: () => void;
}

function Row({ fields, path, text: typed, said, taken, onChange, onRemove }: RowProps) {
  const known = fields.some((field) => field.path === path);
  const field = fields.find((one) => one.path === path);
  return (
    <div class="sweep-axis" role="group" aria-label={text.sweepOver(path)}>
      <select
        aria-label={text.field}
        value={path}
        onChange={(event) => onChange({ path: event.currentTarget.value, text: "" })}
      >
        {!known && <option value={path}>{path}</option>}
        {fields
          .filter((one) => one.path === path || !taken.includes(one.path))
          .map((one) => (
            <option key={one.path} value={one.path}>
              {nameOf(one)}
            </option>
          ))}
      </select>
      <input
        type="text"
        aria-label={text.valuesOf(path)}
        placeholder={hintOf(field)}
        value={typed}
        aria-invalid={said.some(Boolean)}
        onInput={(event) => onChange({ path, text: event.currentTarget.value })}
      />
      <button type="button" class="plain" aria-label={text.removeAxis(path)} onClick={onRemove}>
        ✕
      </button>
      <Wrong said={said} />
    </div>
  );
}

function hintOf(field: Leaf | undefined): string {
  if (field?.kind === "choice") return field.options.join(", ");
  if (field?.kind === "flag") return text.flagValues;
  if (field?.kind === "number") return text.commaValues;
  return text.jsonValues;
}

function Wrong({ said }: { said: (string | null)[] }) {
  const sentences = [...new Set(said.filter(Boolean))];
  return sentences.map((sentence) => (
    <p key={sentence} class="wrong-text small" role="alert">
      {sentence}
    </p>
  ));
}
