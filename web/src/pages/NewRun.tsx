/** A new run: choose a preset, change what should differ, see what it costs, start it. */

import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import * as api from "../api/client";
import { messageOf, Problem } from "../api/problem";
import type { Estimate, Experiment, FieldError, Json, Preset, Spec } from "../api/types";
import { useExperiments } from "../live/fetching";
import { dispatch } from "../live/live";
import { navigate } from "../router";
import { complaints, messagesByPath, withValue } from "../view/form/document";
import { formOf } from "../view/form/fields";
import { SpecForm } from "../view/form/SpecForm";
import { words } from "../view/format";
import { Costs } from "../view/Costs";
import { newKey } from "./key";

const SETTLED_MS = 350;

export function NewRunPage() {
  const { value, error } = useExperiments();
  // Those without a preset begin elsewhere: a refinement at its creature.
  const experiments = value?.filter(({ presets }) => presets.length > 0);
  return (
    <main>
      <header class="page-head">
        <h1>New run</h1>
      </header>
      {error && <p class="banner wrong">{error}</p>}
      {!experiments && !error && <p class="quiet loading">Loading …</p>}
      {experiments?.[0] && <Editor experiments={experiments} first={experiments[0]} />}
    </main>
  );
}

interface EditorProps {
  experiments: Experiment[];
  first: Experiment;
}

function Editor({ experiments, first }: EditorProps) {
  const [experiment, setExperiment] = useState(first);
  const [preset, setPreset] = useState(first.presets[0]!);
  const [spec, setSpec] = useState<Spec>(preset.spec);
  const form = useMemo(() => formOf(experiment.schema), [experiment]);
  const slips = useMemo(() => complaints(form, spec), [form, spec]);
  const check = useEstimate(spec, slips);
  const { start, busy, refusal } = useSubmission(spec);
  const errors = [...(refusal?.errors ?? []), ...check.errors];
  const messages = messagesByPath([...slips, ...errors], form, spec);
  const choose = (chosen: Preset, of: Experiment) => {
    setExperiment(of);
    setPreset(chosen);
    setSpec(chosen.spec);
  };
  const state = {
    document: spec as Json,
    original: preset.spec as Json,
    messages,
    change: (path: string, value: Json) => setSpec(withValue(spec, path, value) as Spec),
  };
  return (
    <form
      class="new-run"
      noValidate
      onSubmit={(event) => {
        event.preventDefault();
        void start();
      }}
    >
      {experiments.map((one) => (
        <fieldset key={one.experiment} class="presets">
          <legend>{one.title}</legend>
          {one.presets.map((each) => (
            <button
              type="button"
              key={each.name}
              class="preset"
              aria-pressed={each === preset}
              onClick={() => choose(each, one)}
            >
              <b>{words(each.name)}</b>
              <span>{each.title}</span>
            </button>
          ))}
        </fieldset>
      ))}
      <SpecForm form={form} state={state} />
      <div class="submit-bar">
        <div class="submit-inner">
          <Costs estimate={check.estimate} problem={refusal?.message ?? check.problem} />
          <button class="primary" type="submit" disabled={busy}>
            {busy ? "Starting …" : "Start the run"}
          </button>
        </div>
      </div>
    </form>
  );
}

interface Check {
  estimate: Estimate | null;
  errors: FieldError[];
  problem: string | null;
}

const SLIPPED = "Some values cannot be used; see beside them.";

/** What the spec will cost, or what the server finds wrong, once typing has settled. */
function useEstimate(spec: Spec, slips: FieldError[]): Check {
  const [check, setCheck] = useState<Check>({ estimate: null, errors: [], problem: null });
  useEffect(() => {
    if (slips.length > 0) return setCheck({ estimate: null, errors: [], problem: SLIPPED });
    let wanted = true;
    const show = (next: Check) => wanted && setCheck(next);
    const timer = setTimeout(() => {
      api
        .estimateRun(spec)
        .then((estimate) => show({ estimate, errors: [], problem: null }))
        .catch((error) => {
          const errors = error instanceof Problem ? error.errors : [];
          show({ estimate: null, errors, problem: errors.length ? SLIPPED : messageOf(error) });
        });
    }, SETTLED_MS);
    return () => {
      wanted = false;
      clearTimeout(timer);
    };
  }, [spec, slips]);
  return check;
}

interface Refusal {
  spec: Spec;
  message: string;
  errors: FieldError[];
}

/** Sends the spec; the same spec sent again, after a lost answer, is the same submission. */
function useSubmission(spec: Spec) {
  const [busy, setBusy] = useState(false);
  const [refusal, setRefusal] = useState<Refusal | null>(null);
  const sent = useRef<{ spec: Spec; key: string } | null>(null);
  const start = async () => {
    if (sent.current?.spec !== spec) sent.current = { spec, key: newKey() };
    setBusy(true);
    try {
      const run = await api.createRun(spec, sent.current.key);
      dispatch({ type: "run", run });
      navigate(`/runs/${run.id}`);
    } catch (error) {
      const errors = error instanceof Problem ? error.errors : [];
      setRefusal({ spec, message: errors.length ? SLIPPED : messageOf(error), errors });
      setBusy(false);
      requestAnimationFrame(showFirstError);
    }
  };
  return { start, busy, refusal: refusal?.spec === spec ? refusal : null };
}

function showFirstError(): void {
  document.querySelector<HTMLElement>("[aria-invalid=true]")?.focus();
  document.querySelector(".spec-form .wrong-text")?.scrollIntoView({ block: "center" });
}
