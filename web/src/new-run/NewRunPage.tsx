/** A new run: begin from something, change what should differ, see what it costs, start it. */

import { useEffect, useState } from "preact/hooks";
import { messageOf } from "../api/problem";
import type { Experiment } from "../api/types";
import { useExperiments } from "../store/fetch";
import { setQuery } from "../store/router";
import { ExperimentPicker } from "./ExperimentPicker";
import { readText } from "./readDocument";
import { BaseBar, type CreatureFile } from "./BaseBar";
import { Editor } from "./Editor";
import { usePresetCosts } from "./estimate";
import { ofFound, ofPreset, completeSpec } from "./sources";
import { OpenFileButton, useDocumentDrop } from "./OpenDocument";
import { type DraftState, useDraft } from "./draftState";
import { text } from "./text";
import "./new-run.css";

export function NewRunPage({ query }: { query: URLSearchParams }) {
  const { value: experiments, error } = useExperiments();
  return (
    <main>
      {error && <p class="banner wrong">{error}</p>}
      {!experiments && !error && <p class="quiet loading">{text.loading}</p>}
      {experiments && <NewRunForm experiments={experiments} query={query} />}
    </main>
  );
}

interface NewRunProps {
  experiments: Experiment[];
  query: URLSearchParams;
}

function NewRunForm({ experiments, query }: NewRunProps) {
  const draft = useDraft(query, experiments);
  const { current } = draft;
  const [picked, setPicked] = useState<Experiment | null>(null);
  const [replacing, setReplacing] = useState(false);
  const own = experiments.find(({ experiment }) => experiment === current?.spec.experiment);
  const chosen = picked ?? own ?? experiments[0]!;
  useEffect(() => setPicked(null), [draft.revision]);
  const { take, file } = useDocument(draft, experiments, chosen, own);
  const costs = usePresetCosts(chosen);
  const view = query.get("view") === "json" ? "json" : "form";
  const show = (next: "form" | "json", replace = false) => {
    setReplacing(replace);
    setQuery({ view: next === "json" ? "json" : null });
  };
  const preset = current?.base.kind === "preset" ? current.base.name : null;
  return (
    <>
      <Header take={take} onPaste={() => show("json", true)} />
      {draft.problem && (
        <p class="banner wrong" role="alert">
          {draft.problem}
        </p>
      )}
      <ExperimentPicker
        experiments={experiments}
        chosen={chosen}
        preset={chosen.presets.find(({ name }) => preset === `${chosen.experiment}/${name}`) ?? null}
        estimates={costs}
        onPreset={(one, of) => draft.startFrom(ofPreset(one, of))}
        onExperiment={(one) =>
          one.presets[0] ? draft.startFrom(ofPreset(one.presets[0], one)) : setPicked(one)
        }
      />
      {!current && <p class="quiet loading">{text.loading}</p>}
      {current && own && (
        <>
          <BaseBar {...{ draft, current, experiments, file }} />
          <Editor {...{ draft, current, view, show, take, replacing }} experiment={own} />
        </>
      )}
    </>
  );
}

type Take = (text: string, name: string, typed?: boolean) => string | null;

/** Starts from a document; what was typed as JSON goes on from the same beginning. */
function useDocument(
  draft: DraftState,
  experiments: Experiment[],
  chosen: Experiment,
  own: Experiment | undefined,
): { take: Take; file: CreatureFile | null } {
  const [file, setFile] = useState<CreatureFile | null>(null);
  const take: Take = (text, name, typed = false) => {
    try {
      const found = readText(text, chosen.experiment === "refinement");
      const same = typed && found.kind === "spec" && found.spec.experiment === own?.experiment;
      if (same) {
        const spec = completeSpec(found.spec, experiments);
        draft.change(() => spec);
      } else {
        draft.startFrom(ofFound(found, name, experiments));
        setFile(found.kind === "creature" ? { sha: found.creature.sha256, text } : null);
      }
      return null;
    } catch (error) {
      return messageOf(error);
    }
  };
  useDocumentDrop(take);
  return { take, file };
}

function Header({ take, onPaste }: { take: Take; onPaste: () => void }) {
  return (
    <header class="page-head">
      <h1>{text.newRun}</h1>
      <span class="spring" />
      <span class="quiet small wide-only">{text.dropHint}</span>
      <span class="actions">
        <button type="button" onClick={onPaste}>
          {text.pasteSpec}
        </button>
        <OpenFileButton take={take} />
      </span>
    </header>
  );
}
