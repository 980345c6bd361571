/** The form of a draft with its errors, its cost and its request. */

import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import * as api from "../api/client";
import type { Drawing, Experiment, FieldError, Json, Spec, ForkRequest, SweepRequest } from "../api/types";
import { type Draft, discardDraft } from "../store/draft";
import type { DraftState } from "./draftState";
import { useEstimate, serverErrors } from "./Costs";
import { isForkField, useFork } from "./ForkCard";
import { schemaErrors, errorsByPath, withValue, leavesOf, valueAt } from "./form/document";
import type { FormState } from "./form/Entry";
import { type Section, formOf } from "./form/fields";
import { type Note, withPartner } from "./form/partners";
import { withoutInitial } from "./initialCreatures";
import { type SweepForm, isSweep, useSweepForm } from "./sweep";
import { text } from "./text";
import { applyResponse } from "../store/store";
import { navigate } from "../store/router";
import { newIdempotencyKey } from "../ui/forms";
import { number, words } from "../ui/format";

export function useEditor(draft: DraftState, current: Draft, experiment: Experiment) {
  const { spec } = current;
  const forking = current.base.fork !== undefined;
  const form = useMemo(() => {
    const whole = formOf(experiment.schema);
    return forking ? withoutInitial(whole) : whole;
  }, [experiment, forking]);
  const localErrors = useMemo(() => schemaErrors(form, spec), [form, spec]);
  const check = useEstimate(localErrors.length === 0 ? spec : null, api.estimateRun);
  const drawing = useLast<Drawing>(check.estimate?.drawing);
  const sweep = useSweepForm(form, spec, experiment);
  const fork = useFork(current);
  const sweepRequest = forking ? null : sweep.request;
  const sweepCheck = useEstimate(localErrors.length === 0 ? sweepRequest : null, api.estimateSweep);
  const naming = useNaming(current.base.name, spec as Json, form, draft.changed);
  const alternative = useMemo(() => sweepRequest && { sweep: sweepRequest }, [sweepRequest]);
  const submission = useSubmission(spec, fork.request ?? alternative, naming.chosen);
  const refused = submission.refusal?.errors ?? [];
  const errors = [...localErrors, ...(sweepRequest ? specErrors(refused) : refused), ...check.errors].filter(
    ({ field }) => !forking || !isForkField(field),
  );
  const state = useFormState(draft, form, current, errors);
  const invalidSweep = !forking && isSweep(sweep) && !sweepRequest && hasProblems(sweep);
  const blocked = localErrors.length > 0 || invalidSweep ? text.hasErrors : check.problem;
  const problem = submission.refusal?.problem ?? blocked ?? sweepCheck.problem;
  return {
    ...{ form, state, errors, refused, forking, fork, naming },
    ...{ sweep, check, submission, invalidSweep, problem },
    /** The last drawing, which stays while values are typed. */
    drawing,
    sweepErrors: sweepCheck.errors,
    estimate: sweepRequest ? sweepCheck.estimate : check.estimate,
    runs: sweepRequest ? sweep.total : 1,
  };
}

export type EditorState = ReturnType<typeof useEditor>;

/** The last value that was there. */
function useLast<T>(value: T | undefined): T | null {
  const last = useRef<T | null>(null);
  if (value !== undefined) last.current = value;
  return last.current;
}

/** The values that the form shows, and functions that change them. */
function useFormState(draft: DraftState, form: Section, current: Draft, errors: FieldError[]): FormState {
  const [document, original] = [current.spec as Json, current.base.spec as Json];
  const [closed, close] = useClosed(form);
  return {
    document,
    original,
    changed: draft.changed,
    errors: errorsByPath(errors, form, document),
    ...usePartners(draft, form, original, document),
    closed,
    close,
  };
}

/** Changes of the spec, after which the form may change another choice too. */
function usePartners(
  draft: DraftState,
  form: Section,
  original: Json,
  shown: Json,
): Pick<FormState, "change" | "note"> {
  const [note, setNote] = useState<Note | null>(null);
  const changed = (now: Json, path: string, value: Json) =>
    withPartner(form, original, now, withValue(now, path, value));
  const change = (path: string, value: Json) => {
    const made = changed(shown, path, value).note;
    if (made) setNote(made);
    draft.change((now) => changed(now as Json, path, value).document as Spec);
  };
  return { change, note };
}

/** Errors of a sweep about its spec, by the fields of the spec. */
const specErrors = (errors: readonly FieldError[]): FieldError[] =>
  errors
    .filter(({ field }) => field.startsWith("spec."))
    .map((error) => ({ ...error, field: error.field.slice("spec.".length) }));

const hasProblems = ({ problems: { seeds, axes, total } }: SweepForm) =>
  [seeds, total, ...axes].some((problem) => problem !== null);

/** The collapsed sections: at first those that are seldom changed. */
function useClosed(form: Section): [ReadonlySet<string>, FormState["close"]] {
  const seldom = useMemo(
    () => new Set(form.fields.filter((field) => "seldom" in field).map(({ path }) => path)),
    [form],
  );
  const [closed, setClosed] = useState<ReadonlySet<string>>(seldom);
  useEffect(() => setClosed(seldom), [seldom]);
  const close = (path: string, isClosed: boolean) =>
    setClosed((now) => new Set(isClosed ? [...now, path] : [...now].filter((each) => each !== path)));
  return [closed, close];
}

export type Alternative = { sweep: SweepRequest } | { fork: ForkRequest };

type Refusal = ReturnType<typeof serverErrors> & { requested: Spec | Alternative };

/** Send the spec, or another request; the same request sent again after a lost answer has the same key. */
function useSubmission(spec: Spec, alternative: Alternative | null, name: string | null) {
  const requested = alternative ?? spec;
  const [busy, setBusy] = useState(false);
  const [refusal, setRefusal] = useState<Refusal | null>(null);
  const sent = useRef<{ requested: Spec | Alternative; name: string | null; key: string } | null>(null);
  const start = async () => {
    if (busy) return;
    if (sent.current?.requested !== requested || sent.current.name !== name) {
      sent.current = { requested, name, key: newIdempotencyKey() };
    }
    setBusy(true);
    try {
      const page = await submit(spec, alternative, sent.current.key, name);
      discardDraft();
      navigate(page);
    } catch (error) {
      setRefusal({ requested, ...serverErrors(error) });
      setBusy(false);
      requestAnimationFrame(showFirstError);
    }
  };
  return { start, busy, refusal: refusal?.requested === requested ? refusal : null };
}

async function submit(
  spec: Spec,
  request: Alternative | null,
  key: string,
  name: string | null,
): Promise<string> {
  if (request && "sweep" in request) return `/sweeps/${(await api.createSweep(request.sweep, key)).id}`;
  const made = request ? api.forkRun(request.fork, key) : api.createRun(spec, key, name);
  return `/runs/${(await applyResponse("change", made)).id}`;
}

function showFirstError(): void {
  document.querySelector<HTMLElement>("[aria-invalid=true]")?.focus();
  document.querySelector(".spec-form .wrong-text")?.scrollIntoView({ block: "center" });
}

/** Changes that a name tells. */
const MOST = 3;

/** The name of a new run, made from what differs from its source unless one is typed. */
function useNaming(source: string, document: Json, form: Section, changed: ReadonlySet<string>) {
  const [typed, type] = useState("");
  const suggested = nameOf(source, document, form, changed);
  return { typed, type, suggested, chosen: typed.trim() || suggested };
}

/** `Demo, viscosity 0.2, nodes 32`; null if nothing differs that a few words can tell. */
export function nameOf(
  source: string,
  document: Json,
  form: Section,
  changed: ReadonlySet<string>,
): string | null {
  const told = leavesOf(form, document).flatMap(({ path, title }) => {
    const value = valueAt(document, path);
    if (!changed.has(path) || value === null || typeof value === "object") return [];
    const shown = typeof value === "number" ? number(value, 4) : String(value).replaceAll("_", " ");
    return [`${title.toLowerCase()} ${shown}`];
  });
  if (told.length === 0) return null;
  return [titleOf(source), ...told.slice(0, MOST)].filter(Boolean).join(", ");
}

/** The title of a preset, with its experiment unless that is the usual one; ids have none. */
function titleOf(source: string): string | null {
  const [experiment, preset] = source.split("/") as [string, string | undefined];
  if (!preset) return null;
  return words(experiment === "quality-diversity" ? preset : `${experiment.replaceAll("-", " ")} ${preset}`);
}
