/** The page of a new run: choose a source or open a document, change its spec, see the cost, start. */

import { useEffect, useState } from "preact/hooks";
import type { Experiment } from "../api/types";
import { useExperiments } from "../store/fetch";
import { setQuery } from "../store/router";
import { Loading, Page } from "../ui/Page";
import { ExperimentPicker } from "./ExperimentPicker";
import { type CreatureFile, BaseBar } from "./BaseBar";
import { Editor } from "./Editor";
import { usePresetCosts } from "./Costs";
import { baseOfPreset, readText, completeSpec, baseOfDocument } from "./sources";
import { type DraftState, useDraft } from "./draftState";
import { text } from "./text";
import "./new-run.css";
import { messageOf } from "../api/problem";
import { useListener } from "../store/polling";
import { showToast } from "../store/toasts";
import { FileButton, useFileDrop } from "../ui/DropTarget";

export function NewRunPage({ query }: { query: URLSearchParams }) {
  const { value: experiments, error } = useExperiments();
  if (!experiments) return <Page error={error} loading />;
  return <NewRunForm experiments={experiments} query={query} />;
}

function NewRunForm({ experiments, query }: { experiments: Experiment[]; query: URLSearchParams }) {
  const draft = useDraft(query, experiments);
  const { current } = draft;
  const [picked, setPicked] = useState<Experiment | null>(null);
  const [replacing, setReplacing] = useState(false);
  const experiment = experiments.find((one) => one.experiment === current?.spec.experiment);
  const selected = picked ?? experiment ?? experiments[0]!;
  useEffect(() => setPicked(null), [draft.revision]);
  const { open, file } = useDocument(draft, experiments, selected, experiment);
  const costs = usePresetCosts(selected);
  const view = query.get("view") === "json" ? "json" : "form";
  const show = (next: "form" | "json", replace = false) => {
    setReplacing(replace);
    setQuery({ view: next === "json" ? "json" : null });
  };
  const preset = current?.base.kind === "preset" ? current.base.name : null;
  return (
    <Page title={text.newRun} actions={<SourceButtons open={open} onPaste={() => show("json", true)} />}>
      {draft.problem && (
        <p class="banner wrong" role="alert">
          {draft.problem}
        </p>
      )}
      <ExperimentPicker
        experiments={experiments}
        selected={selected}
        preset={selected.presets.find(({ name }) => preset === `${selected.experiment}/${name}`) ?? null}
        estimates={costs}
        onPreset={(one, of) => draft.startFrom(baseOfPreset(one, of))}
        onExperiment={(one) =>
          one.presets[0] ? draft.startFrom(baseOfPreset(one.presets[0], one)) : setPicked(one)
        }
      />
      {!current && <Loading />}
      {current && experiment && (
        <>
          <BaseBar {...{ draft, current, experiments, file }} />
          <Editor {...{ draft, current, view, show, open, replacing }} experiment={experiment} />
        </>
      )}
    </Page>
  );
}

function SourceButtons({ open, onPaste }: { open: OpenDocument; onPaste: () => void }) {
  return (
    <>
      <span class="spring" />
      <span class="quiet small wide-only">{text.dropHint}</span>
      <span class="actions">
        <button type="button" onClick={onPaste}>
          {text.pasteSpec}
        </button>
        <OpenFileButton open={open} />
      </span>
    </>
  );
}

/** Start from a document; return what is wrong with it, or null. */
type OpenDocument = (text: string, name: string, typed?: boolean) => string | null;

/** Start from documents; JSON typed in the editor changes the spec and keeps its source. */
function useDocument(
  draft: DraftState,
  experiments: Experiment[],
  selected: Experiment,
  current: Experiment | undefined,
): { open: OpenDocument; file: CreatureFile | null } {
  const [file, setFile] = useState<CreatureFile | null>(null);
  const open: OpenDocument = (text, name, typed = false) => {
    try {
      const read = readText(text, selected.experiment === "refinement");
      const same = typed && read.kind === "spec" && read.spec.experiment === current?.experiment;
      if (same) {
        const spec = completeSpec(read.spec, experiments);
        draft.change(() => spec);
      } else {
        draft.startFrom(baseOfDocument(read, name, experiments));
        setFile(read.kind === "creature" ? { sha: read.creature.sha256, text } : null);
      }
      return null;
    } catch (error) {
      return messageOf(error);
    }
  };
  useDocumentDrop(open);
  return { open, file };
}

/** Handle text pasted outside fields, and dropped files. */
function useDocumentDrop(open: OpenDocument): void {
  useFileDrop(text.dropDocument, (file) => void readFile(open, file));
  useListener("paste", (event: ClipboardEvent) => {
    if ((event.target as Element).closest?.("input, textarea, select")) return;
    const pasted = event.clipboardData?.getData("text") ?? "";
    if (!pasted.trim()) return;
    event.preventDefault();
    showProblem(open(pasted, ""), text.pasted);
  });
}

async function readFile(open: OpenDocument, file: File): Promise<void> {
  showProblem(open(await file.text(), file.name), file.name);
}

function showProblem(problem: string | null, what: string): void {
  if (problem) showToast({ kind: "wrong", text: `${what}: ${problem}` });
}

function OpenFileButton({ open }: { open: OpenDocument }) {
  return (
    <FileButton name={text.documentFile} onFile={(file) => void readFile(open, file)}>
      {text.openFile}
    </FileButton>
  );
}
