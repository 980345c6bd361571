/** The editor of a spec, as a form or as JSON, with a drawing and the estimated cost. */

import { useRef, useState } from "preact/hooks";
import type { Experiment, Json } from "../api/types";
import { useRefusal } from "../store/principal";
import { useListener } from "../store/polling";
import type { Draft } from "../store/draft";
import { BodyDrawing } from "./BodyDrawing";
import { CostDetails, Costs } from "./Costs";
import type { DraftState } from "./draftState";
import { type EditorState, useEditor } from "./editorState";
import { ForkCard } from "./ForkCard";
import { isSweep } from "./sweep";
import { SpecView, type View } from "./SpecView";
import { SweepCard } from "./SweepCard";
import { lazy } from "../ui/lazy";
import { text } from "./text";
import "./form/form.css";

interface Props {
  draft: DraftState;
  current: Draft;
  experiment: Experiment;
  view: View;
  show: (view: View) => void;
  open: (text: string, file: string, typed?: boolean) => string | null;
  replacing: boolean;
}

export function Editor(props: Props) {
  const { draft, current, experiment } = props;
  const editor = useEditor(draft, current, experiment);
  const { check, forking, submission, sweep } = editor;
  const [illegible, setIllegible] = useState<string | null>(null);
  const form = useRef<HTMLFormElement>(null);
  useSubmitKey(form);
  const refusal = useRefusal();
  return (
    <form
      class="new-run"
      noValidate
      ref={form}
      onSubmit={(event) => {
        event.preventDefault();
        if (!illegible && !editor.invalidSweep && !refusal) void submission.start();
      }}
    >
      <div class="new-columns">
        <aside class="new-side" aria-label={text.overview}>
          <section class={`card ${check.estimate ? "" : "stale"}`} aria-label={text.body}>
            {begins(current.spec as Json) && check.estimate && !refusal && <Preview spec={current.spec} />}
            <BodyDrawing drawing={editor.drawing} />
          </section>
          {check.estimate && <CostDetails estimate={check.estimate} />}
        </aside>
        <div class="new-spec">
          <SpecView {...props} {...{ editor, illegible }} onProblem={setIllegible} />
          {forking ? (
            <ForkCard fork={editor.fork} errors={[...editor.refused, ...check.errors]} />
          ) : (
            <SweepCard
              sweep={sweep}
              errors={[...editor.refused, ...editor.sweepErrors]}
              spec={current.spec as Json}
            />
          )}
        </div>
      </div>
      <SubmitBar editor={editor} illegible={illegible !== null} refusal={refusal} />
    </form>
  );
}

/** The simulator is loaded when a creature shall swim. */
const FirstCreature = lazy(() => import("./FirstCreature").then((found) => found.FirstCreature), null);

function Preview({ spec }: { spec: Draft["spec"] }) {
  const [on, setOn] = useState(false);
  if (on) return <FirstCreature spec={spec} />;
  return (
    <button type="button" class="first-show" onClick={() => setOn(true)}>
      {text.firstShow}
    </button>
  );
}

/** True if a run starts from random creatures. */
function begins(spec: Json): boolean {
  const { experiment, search } = spec as { experiment?: string; search?: { initial?: unknown[] } };
  return ["quality-diversity", "neuroevolution"].includes(experiment ?? "") && !search?.initial?.length;
}

interface SubmitProps {
  editor: EditorState;
  illegible: boolean;
  refusal: string | null;
}

function SubmitBar({ editor, illegible, refusal }: SubmitProps) {
  const { estimate, runs, problem, submission, sweep, forking } = editor;
  const total = !forking && isSweep(sweep) ? sweep.total : 1;
  return (
    <div class="submit-bar">
      <div class="row">
        <Costs {...{ estimate, runs }} problem={illegible ? text.invalidJson : problem} />
        <span class="spring" />
        {refusal ? (
          <span class="quiet">{refusal}</span>
        ) : (
          <kbd class="quiet small wide-only">{text.submitKey}</kbd>
        )}
        <button class="primary" type="submit" disabled={submission.busy || refusal !== null}>
          {submission.busy ? text.starting : startLabel(total)}
        </button>
      </div>
    </div>
  );
}

const startLabel = (runs: number) => (runs <= 1 ? text.start : text.startRuns(runs.toLocaleString("en")));

/** Submit on Control or Command with Enter, wherever the focus is. */
function useSubmitKey(form: { current: HTMLFormElement | null }): void {
  useListener("keydown", (event: KeyboardEvent) => {
    if (event.key !== "Enter" || !(event.ctrlKey || event.metaKey)) return;
    event.preventDefault();
    form.current?.requestSubmit();
  });
}
