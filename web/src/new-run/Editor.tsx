/** The spec at hand: as a form or as JSON, with what it is about and what it will cost. */

import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Experiment, FieldError, Json, Spec } from "../api/types";
import { useRefusal } from "../store/principal";
import type { Draft } from "../store/draft";
import { BodyDrawing } from "./BodyDrawing";
import { CostDetails, Costs } from "./Costs";
import { Outline } from "./form/Outline";
import { Segments } from "../ui/Select";
import { complaints, messagesByPath, withValue } from "./form/document";
import type { FormState } from "./form/Entry";
import { type Section, formOf } from "./form/fields";
import { JsonView } from "./form/JsonView";
import { withoutInitial } from "./initialCreatures";
import { SpecForm, partsOf } from "./form/SpecForm";
import { HAS_ERRORS, useEstimate } from "./estimate";
import { ForkCard, isForkField } from "./ForkCard";
import { useFork } from "./fork";
import { useSubmission } from "./submission";
import { SweepCard, goToSweep } from "./SweepCard";
import { type SweepForm, isSweep, useSweepEstimate, useSweepForm } from "./sweep";
import type { DraftState } from "./draftState";
import "./form/form.css";

interface EditorProps {
  desk: DraftState;
  work: Draft;
  experiment: Experiment;
  view: "form" | "json";
  show: (view: "form" | "json") => void;
  take: (text: string, file: string, typed?: boolean) => string | null;
  replacing: boolean;
}

export function Editor({ desk, work, experiment, view, show, take, replacing }: EditorProps) {
  const { spec, base } = work;
  const forking = base.fork !== undefined;
  const form = useMemo(() => {
    const whole = formOf(experiment.schema);
    return forking ? withoutInitial(whole) : whole;
  }, [experiment, forking]);
  const parts = useMemo(() => partsOf(form), [form]);
  const slips = useMemo(() => complaints(form, spec), [form, spec]);
  const check = useEstimate(spec, slips);
  const [illegible, setIllegible] = useState<string | null>(null);
  const sweeping = useSweepForm(form, spec, experiment);
  const fork = useFork(work);
  const many = forking ? null : sweeping.sent;
  const all = useSweepEstimate(slips.length === 0 ? many : null);
  const sweep = useMemo(() => many && { sweep: many }, [many]);
  const submission = useSubmission(spec, fork.sent ?? sweep);
  const refused = (submission.refusal?.errors ?? []).map(fieldError);
  const errors = [...slips, ...(many ? specErrors(refused) : refused), ...check.errors].filter(
    ({ field }) => !forking || !isForkField(field),
  );
  const slipped = !forking && isSweep(sweeping) && !many && hasProblems(sweeping);
  const [closed, close] = useClosed(form);
  const state: FormState = {
    document: spec as Json,
    original: base.spec as Json,
    changed: desk.changed,
    messages: messagesByPath(errors, form, spec),
    change: (path, value) => desk.change((now) => withValue(now, path, value) as Spec),
    closed,
    close,
  };
  const element = useRef<HTMLFormElement>(null);
  useSubmitKey(element);
  const refusal = useRefusal();
  return (
    <form
      class="new-run"
      noValidate
      ref={element}
      onSubmit={(event) => {
        event.preventDefault();
        if (!illegible && !slipped && !refusal) void submission.start();
      }}
    >
      <div class="new-columns">
        <aside class="new-side" aria-label="The run at a glance">
          <section class={`card ${check.estimate ? "" : "stale"}`} aria-label="Body">
            <BodyDrawing drawing={check.drawing} />
          </section>
          {check.estimate && <CostDetails estimate={check.estimate} />}
        </aside>
        <div class="new-spec">
          <div class="spec-bar">
            <Segments label="How the spec is shown" choices={VIEWS} value={view} onChoose={show} />
            {view === "form" && <Outline parts={parts} state={state} />}
            {!forking && (
              <button type="button" class="plain wide-only" onClick={goToSweep}>
                Several runs
              </button>
            )}
          </div>
          {view === "form" && <SpecForm form={form} state={state} />}
          {view === "json" && (
            <JsonView
              key={desk.revision}
              spec={spec}
              errors={illegible ? [] : errors}
              take={(text) => take(text, "", true)}
              onProblem={setIllegible}
              replace={replacing}
            />
          )}
          {forking ? (
            <ForkCard {...fork} errors={[...refused, ...check.errors]} />
          ) : (
            <SweepCard sweeping={sweeping} errors={[...refused, ...all.errors]} spec={spec as Json} />
          )}
        </div>
      </div>
      <div class="submit-bar">
        <div class="submit-inner">
          <Costs
            estimate={many ? all.estimate : check.estimate}
            runs={many ? sweeping.total : 1}
            problem={
              illegible
                ? "What is written as JSON cannot be used."
                : (submission.refusal?.message ??
                  check.problem ??
                  (slipped || all.errors.length > 0 ? HAS_ERRORS : all.problem))
            }
          />
          <span class="submit-how">
            {refusal ? <span class="quiet">{refusal}</span> : <kbd class="quiet wide-only">Ctrl + Enter</kbd>}
            <button class="primary" type="submit" disabled={submission.busy || refusal !== null}>
              {submission.busy
                ? "Starting …"
                : startLabel(!forking && isSweep(sweeping) ? sweeping.total : 1)}
            </button>
          </span>
        </div>
      </div>
    </form>
  );
}

const startLabel = (runs: number) =>
  runs <= 1 ? "Start the run" : `Start ${runs.toLocaleString("en")} runs`;

/** What a refused sweep says of the spec itself stands beside its fields. */
const specErrors = (errors: readonly FieldError[]): FieldError[] =>
  errors
    .filter(({ field }) => field.startsWith("spec."))
    .map((error) => ({ ...error, field: error.field.slice("spec.".length) }));

/** What a creature does not fit may be told of a part of the spec: `control: inputs`. */
const fieldError = (error: FieldError): FieldError => ({ ...error, field: error.field.replace(/: .*/, "") });

const hasProblems = ({ problems: { seeds, axes, total } }: SweepForm) =>
  [seeds, total, ...axes].some((problem) => problem !== null);

const VIEWS = [
  ["form", "Form"],
  ["json", "JSON"],
] as const;

/** Which parts are shown closed: at first those that are seldom changed. */
function useClosed(form: Section): [ReadonlySet<string>, FormState["close"]] {
  const seldom = useMemo(
    () => new Set(form.fields.filter((field) => "seldom" in field).map(({ path }) => path)),
    [form],
  );
  const [closed, setClosed] = useState<ReadonlySet<string>>(seldom);
  useEffect(() => setClosed(seldom), [seldom]);
  const close = (path: string, shut: boolean) =>
    setClosed((now) => new Set(shut ? [...now, path] : [...now].filter((each) => each !== path)));
  return [closed, close];
}

/** Control or Command with Enter submits, wherever the focus is. */
function useSubmitKey(form: { current: HTMLFormElement | null }): void {
  useEffect(() => {
    const press = (event: KeyboardEvent) => {
      if (event.key !== "Enter" || !(event.ctrlKey || event.metaKey)) return;
      event.preventDefault();
      form.current?.requestSubmit();
    };
    document.addEventListener("keydown", press);
    return () => document.removeEventListener("keydown", press);
  }, []);
}
