/** The form of a draft with its errors, its cost, and what is sent when it is submitted. */

import { useEffect, useMemo, useState } from "preact/hooks";
import type { Experiment, FieldError, Json, Spec } from "../api/types";
import type { Draft } from "../store/draft";
import type { DraftState } from "./draftState";
import { HAS_ERRORS, useEstimate } from "./estimate";
import { useFork } from "./fork";
import { isForkField } from "./ForkCard";
import { complaints, messagesByPath, withValue } from "./form/document";
import type { FormState } from "./form/Entry";
import { type Section, formOf } from "./form/fields";
import { withoutInitial } from "./initialCreatures";
import { useSubmission } from "./submission";
import { type SweepForm, isSweep, useSweepEstimate, useSweepForm } from "./sweep";

export function useEditor(draft: DraftState, current: Draft, experiment: Experiment) {
  const { spec, base } = current;
  const forking = base.fork !== undefined;
  const form = useMemo(() => {
    const whole = formOf(experiment.schema);
    return forking ? withoutInitial(whole) : whole;
  }, [experiment, forking]);
  const slips = useMemo(() => complaints(form, spec), [form, spec]);
  const check = useEstimate(spec, slips);
  const sweep = useSweepForm(form, spec, experiment);
  const fork = useFork(current);
  const many = forking ? null : sweep.sent;
  const all = useSweepEstimate(slips.length === 0 ? many : null);
  const sent = useMemo(() => many && { sweep: many }, [many]);
  const submission = useSubmission(spec, fork.sent ?? sent);
  const refused = (submission.refusal?.errors ?? []).map(fieldError);
  const errors = [...slips, ...(many ? specErrors(refused) : refused), ...check.errors].filter(
    ({ field }) => !forking || !isForkField(field),
  );
  const [closed, close] = useClosed(form);
  const state: FormState = {
    document: spec as Json,
    original: base.spec as Json,
    changed: draft.changed,
    messages: messagesByPath(errors, form, spec),
    change: (path, value) => draft.change((now) => withValue(now, path, value) as Spec),
    closed,
    close,
  };
  const slipped = !forking && isSweep(sweep) && !many && hasProblems(sweep);
  const problem =
    submission.refusal?.message ??
    check.problem ??
    (slipped || all.errors.length > 0 ? HAS_ERRORS : all.problem);
  return {
    ...{ form, state, errors, refused, forking, fork, sweep, check, submission, slipped, problem },
    sweepErrors: all.errors,
    estimate: many ? all.estimate : check.estimate,
    /** How many runs will be started, if what is typed is right. */
    runs: many ? sweep.total : 1,
  };
}

export type EditorState = ReturnType<typeof useEditor>;

/** What a refused sweep says of the spec itself stands beside its fields. */
const specErrors = (errors: readonly FieldError[]): FieldError[] =>
  errors
    .filter(({ field }) => field.startsWith("spec."))
    .map((error) => ({ ...error, field: error.field.slice("spec.".length) }));

/** What a creature does not fit may be told of a part of the spec: `control: inputs`. */
const fieldError = (error: FieldError): FieldError => ({ ...error, field: error.field.replace(/: .*/, "") });

const hasProblems = ({ problems: { seeds, axes, total } }: SweepForm) =>
  [seeds, total, ...axes].some((problem) => problem !== null);

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
