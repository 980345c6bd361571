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
import { useDraft } from "./draftState";
import "./new-run.css";

export function NewRunPage({ query }: { query: URLSearchParams }) {
  const { value: experiments, error } = useExperiments();
  return (
    <main>
      {error && <p class="banner wrong">{error}</p>}
      {!experiments && !error && <p class="quiet loading">Loading …</p>}
      {experiments && <NewRunForm experiments={experiments} query={query} />}
    </main>
  );
}

interface NewRunProps {
  experiments: Experiment[];
  query: URLSearchParams;
}

function NewRunForm({ experiments, query }: NewRunProps) {
  const desk = useDraft(query, experiments);
  const [picked, setPicked] = useState<Experiment | null>(null);
  const [file, setFile] = useState<CreatureFile | null>(null);
  const [replacing, setReplacing] = useState(false);
  const own = experiments.find(({ experiment }) => experiment === desk.work?.spec.experiment);
  const chosen = picked ?? own ?? experiments[0]!;
  useEffect(() => setPicked(null), [desk.revision]);
  /** Begins from a document; what was typed as JSON goes on from the same beginning. */
  const take = (text: string, name: string, typed = false): string | null => {
    try {
      const found = readText(text, chosen.experiment === "refinement");
      const same = typed && found.kind === "spec" && found.spec.experiment === own?.experiment;
      if (same) {
        const spec = completeSpec(found.spec, experiments);
        desk.change(() => spec);
      } else {
        desk.startFrom(ofFound(found, name, experiments));
        setFile(found.kind === "creature" ? { sha: found.creature.sha256, text } : null);
      }
      return null;
    } catch (error) {
      return messageOf(error);
    }
  };
  useDocumentDrop(take);
  const costs = usePresetCosts(chosen);
  const view = query.get("view") === "json" ? "json" : "form";
  const show = (next: "form" | "json", replace = false) => {
    setReplacing(replace);
    setQuery({ view: next === "json" ? "json" : null });
  };
  const { work } = desk;
  const base = work?.base;
  const preset = base?.kind === "preset" ? base.name : null;
  return (
    <>
      <header class="page-head">
        <h1>New run</h1>
        <span class="spring" />
        <span class="quiet small wide-only">Paste or drop a spec, a run or a creature file, or</span>
        <span class="actions">
          <button type="button" onClick={() => show("json", true)}>
            Paste a spec
          </button>
          <OpenFileButton take={take} />
        </span>
      </header>
      {desk.problem && (
        <p class="banner wrong" role="alert">
          {desk.problem}
        </p>
      )}
      <ExperimentPicker
        experiments={experiments}
        chosen={chosen}
        preset={chosen.presets.find(({ name }) => preset === `${chosen.experiment}/${name}`) ?? null}
        estimates={costs}
        onPreset={(one, of) => desk.startFrom(ofPreset(one, of))}
        onExperiment={(one) =>
          one.presets[0] ? desk.startFrom(ofPreset(one.presets[0], one)) : setPicked(one)
        }
      />
      {!work && <p class="quiet loading">Loading …</p>}
      {work && own && (
        <>
          <BaseBar {...{ desk, work, experiments, file }} />
          <Editor {...{ desk, work, view, show, take, replacing }} experiment={own} />
        </>
      )}
    </>
  );
}
