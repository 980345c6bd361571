/** The page of a new run: choose a source, change its spec, see the cost, start. */

import { useEffect, useState } from "preact/hooks";
import type { Experiment } from "../api/types";
import { useExperiments } from "../store/fetch";
import { setQuery } from "../store/router";
import { Loading, Page } from "../ui/Page";
import { ExperimentPicker } from "./ExperimentPicker";
import { BaseBar } from "./BaseBar";
import { Editor } from "./Editor";
import { usePresetCosts } from "./Costs";
import { baseOfPreset } from "./sources";
import { type OpenDocument, OpenFileButton, useDocument } from "./OpenDocument";
import { useDraft } from "./draftState";
import { text } from "./text";
import "./new-run.css";

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
