/** Seeds and a grid of field values for several runs. */

import type { FieldError, Json } from "../api/types";
import { number } from "../ui/format";
import { valueAt } from "./form/document";
import type { Leaf } from "./form/fields";
import { Card } from "../ui/Page";
import { Options } from "../ui/Select";
import { NameEntry } from "./ForkCard";
import { Messages } from "./form/Entry";
import { type Axis, type SweepForm, nameOf, isSweep, errorsAt } from "./sweep";
import { text } from "./text";

interface Props {
  sweep: SweepForm;
  errors: readonly FieldError[];
  spec: Json;
}

export function SweepCard({ sweep, errors, spec }: Props) {
  const { axes, fields, problems, total, change } = sweep;
  const add = () => {
    const free = fields.find(({ path }) => !axes.some((axis) => axis.path === path));
    const preferred = fields.find(({ path }) => path === "world.viscosity") ?? free;
    const next = axes.some(({ path }) => path === preferred?.path) ? free : preferred;
    if (next) change({ axes: [...axes, { path: next.path, text: textOf(valueAt(spec, next.path)) }] });
  };
  return (
    <Card id="sweep" kind="sweep-card" title={text.sweep}>
      <p class="help">{text.sweepAbout}</p>
      <Entries sweep={sweep} />
      <Messages messages={[problems.seeds, ...errorsAt(errors, "seeds")]} />
      {axes.map((axis, i) => (
        <Row
          key={i}
          fields={fields}
          axis={axis}
          messages={[problems.axes[i] ?? null, ...errorsAt(errors, `grid.${axis.path}`)]}
          taken={axes.map(({ path }) => path)}
          onChange={(next) => change({ axes: axes.with(i, next) })}
          onRemove={() => change({ axes: axes.toSpliced(i, 1) })}
        />
      ))}
      <Messages messages={[problems.total, ...errorsAt(errors, "grid")]} />
      <p class="sweep-foot row">
        <button type="button" onClick={add} disabled={axes.length >= fields.length}>
          {text.addAxis(axes.length === 0)}
        </button>
        {isSweep(sweep) && (
          <span role="status" class="quiet">
            {text.totalRuns(total)}
          </span>
        )}
      </p>
    </Card>
  );
}

function Entries({ sweep }: { sweep: SweepForm }) {
  const { seeded, seeds, name, problems, change } = sweep;
  return (
    <div class="sweep-entries row">
      {seeded && (
        <label class="sweep-seeds over">
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
      {isSweep(sweep) && (
        <NameEntry title={text.sweepName} value={name} onChange={(name) => change({ name })} />
      )}
    </div>
  );
}

export function goToSweep(): void {
  const card = document.querySelector(".sweep-card");
  card?.scrollIntoView({ block: "center" });
  card?.querySelector<HTMLElement>("input, button")?.focus({ preventScroll: true });
}

function textOf(value: Json): string {
  if (value === null || typeof value === "object") return "";
  return typeof value === "number" && Math.abs(value) < 1e-4 ? number(value, 6) : String(value);
}

interface RowProps {
  fields: readonly Leaf[];
  axis: Axis;
  messages: (string | null)[];
  taken: string[];
  onChange: (axis: Axis) => void;
  onRemove: () => void;
}

function Row({ fields, axis, messages, taken, onChange, onRemove }: RowProps) {
  const { path } = axis;
  const field = fields.find((one) => one.path === path);
  const free = fields.filter((one) => one.path === path || !taken.includes(one.path));
  const choices = free.map((one) => [one.path, nameOf(one)] as const);
  return (
    <div class="sweep-axis" role="group" aria-label={text.sweepOver(path)}>
      <select
        aria-label={text.field}
        value={path}
        onChange={(event) => onChange({ path: event.currentTarget.value, text: "" })}
      >
        <Options of={field ? choices : [[path, path], ...choices]} />
      </select>
      <input
        type="text"
        aria-label={text.valuesOf(path)}
        placeholder={hintOf(field)}
        value={axis.text}
        aria-invalid={messages.some(Boolean)}
        onInput={(event) => onChange({ path, text: event.currentTarget.value })}
      />
      <button type="button" class="plain" aria-label={text.removeAxis(path)} onClick={onRemove}>
        ✕
      </button>
      <Messages messages={messages} />
    </div>
  );
}

function hintOf(field: Leaf | undefined): string {
  if (field?.kind === "choice") return field.options.join(", ");
  if (field?.kind === "flag") return text.flagValues;
  if (field?.kind === "number") return text.commaValues;
  return text.jsonValues;
}
