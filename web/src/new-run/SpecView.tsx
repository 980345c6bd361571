/** The spec of a new run: the essentials, all settings if asked for, or JSON. */

import { Fragment } from "preact";
import { useMemo, useState, useEffect } from "preact/hooks";
import type { Estimate } from "../api/types";
import type { Draft } from "../store/draft";
import { keep, readKept } from "../store/kept";
import { Segments } from "../ui/Select";
import type { DraftState } from "./draftState";
import type { EditorState } from "./editorState";
import { type FormState, Entry } from "./form/Entry";
import { JsonView } from "./form/JsonView";
import { KindSelect, Outline, SpecForm, partsOf } from "./form/SpecForm";
import { essentialsOf, searched } from "./form/essentials";
import type { Leaf, Section } from "./form/fields";
import { text as formText } from "./form/text";
import { goToSweep } from "./SweepCard";
import { text } from "./text";
import { valueAt } from "./form/document";

export type View = "form" | "json";

const VIEWS = [
  ["form", text.form],
  ["json", text.json],
] as const;

interface Props {
  editor: EditorState;
  draft: DraftState;
  current: Draft;
  view: View;
  show: (view: View) => void;
  open: (text: string, file: string, typed?: boolean) => string | null;
  replacing: boolean;
  illegible: string | null;
  onProblem: (problem: string | null) => void;
}

export function SpecView(props: Props) {
  const { editor, illegible, onProblem, draft, current, view, show, open, replacing } = props;
  return (
    <>
      <div class="spec-bar">
        <Segments label={text.specView} choices={VIEWS} value={view} onSelect={show} />
        {!editor.forking && (
          <button type="button" class="plain wide-only" onClick={goToSweep}>
            {text.severalRuns}
          </button>
        )}
      </div>
      {view === "form" && <FormView editor={editor} />}
      {view === "json" && (
        <JsonView
          key={draft.revision}
          spec={current.spec}
          errors={illegible ? [] : editor.errors}
          onText={(text) => open(text, "", true)}
          onProblem={onProblem}
          replace={replacing}
        />
      )}
    </>
  );
}

const ALL_KEY = "microcosmos:all-settings";

/** True if all settings are shown, which the browser keeps for the next run. */
function useAll(): [boolean, (all: boolean) => void] {
  const [all, setAll] = useState(() => readKept(ALL_KEY, 0) > 0);
  const change = (next: boolean) => {
    keep(ALL_KEY, Number(next));
    setAll(next);
  };
  return [all, change];
}

function FormView({ editor }: { editor: EditorState }) {
  const { form, state } = editor;
  const parts = useMemo(() => partsOf(form), [form]);
  const essentials = useMemo(() => essentialsOf(form, state.document), [form, state.document]);
  const [wished, setAll] = useAll();
  const [words, setWords] = useState("");
  // People must see wrong values.
  const hidden = [...state.errors.keys()].some((path) => !essentials.some((field) => field.path === path));
  const all = wished || hidden || essentials.length === 0;
  const found = searched(parts, words);
  return (
    <>
      <RunName editor={editor} />
      <div class="all-bar row">
        {essentials.length > 0 && (
          <button type="button" disabled={hidden} aria-pressed={all} onClick={() => setAll(!all)}>
            {formText.allSettings}
          </button>
        )}
        {all && (
          <>
            <input
              type="search"
              aria-label={formText.findSetting}
              placeholder={formText.findSetting}
              value={words}
              onInput={(event) => setWords(event.currentTarget.value)}
            />
            <Outline parts={parts} state={state} />
          </>
        )}
      </div>
      {!all && <Essentials fields={essentials} {...{ form, state }} estimate={editor.check.estimate} />}
      {all && found.length === 0 && <p class="quiet">{formText.noSetting(words)}</p>}
      {all && <SpecForm parts={found} state={words ? { ...state, closed: new Set() } : state} />}
    </>
  );
}

/** The name of one run; sweeps and forks are named beside what makes them. */
function RunName({ editor: { forking, runs, naming } }: { editor: EditorState }) {
  if (forking || runs !== 1) return null;
  return (
    <label class="run-name-field">
      {formText.runName}
      <input
        maxLength={200}
        placeholder={naming.suggested ?? formText.runNameHint}
        value={naming.typed}
        onInput={(event) => naming.type(event.currentTarget.value)}
      />
    </label>
  );
}

interface EssentialsProps {
  fields: Leaf[];
  form: Section;
  state: FormState;
  estimate: Estimate | null;
}

/** The settings that most people change. */
function Essentials({ fields, form, state, estimate }: EssentialsProps) {
  const body = form.fields.find(({ path }) => path === "body");
  return (
    <fieldset class="card essentials" aria-label={formText.essentialsTitle}>
      {body?.kind === "union" && <KindSelect union={body} state={state} title={formText.body} />}
      {fields.map((field) => (
        <Fragment key={field.path}>
          <Entry field={field} state={state} />
          {field.path === "search.generations" && <TimeBudget estimate={estimate} state={state} />}
        </Fragment>
      ))}
    </fieldset>
  );
}

const GENERATIONS = "search.generations";
const ID = "time-budget";

function TimeBudget({ estimate, state }: { estimate: Estimate | null; state: FormState }) {
  const generations = valueAt(state.document, GENERATIONS);
  const pace = usePace(estimate, generations);
  const [typed, setTyped] = useState<string | null>(null);
  if (pace === null || typeof generations !== "number") return null;
  const minutes = (pace.startup + generations * pace.each) / 60;
  const change = (value: string) => {
    setTyped(value);
    const wanted = generationsIn(Number(value), pace);
    if (wanted !== null) state.change(GENERATIONS, wanted);
  };
  return (
    <div class="entry">
      <span class="entry-name">
        <label for={ID}>{text.minutes}</label>
      </span>
      <input
        {...{ id: ID, type: "number", min: 0, step: "any" }}
        value={typed ?? shownMinutes(minutes)}
        aria-describedby={`${ID}-about`}
        onInput={(event) => change(event.currentTarget.value)}
        onBlur={() => setTyped(null)}
      />
      <div id={`${ID}-about`} class="about">
        <p class="help">{text.minutesAbout}</p>
      </div>
    </div>
  );
}

/** Seconds of the start, in which programs are compiled, and of each generation. */
interface Pace {
  startup: number;
  each: number;
}

/** The pace by the last estimate; null before there is one. */
function usePace(estimate: Estimate | null, generations: unknown): Pace | null {
  const [pace, setPace] = useState<Pace | null>(null);
  useEffect(() => {
    // An answer belongs to the generations for which it was asked: the form has not changed since.
    if (estimate && typeof generations === "number") setPace((old) => paceOf(estimate, generations) ?? old);
  }, [estimate]);
  return pace;
}

export function paceOf(
  { seconds, cell_steps, speed }: Pick<Estimate, "seconds" | "cell_steps" | "speed">,
  generations: number,
): Pace | null {
  if (!seconds || !speed) return null;
  const computing = cell_steps / speed.cell_steps_per_second;
  return { startup: Math.max(0, seconds - computing), each: computing / generations };
}

/** The number of generations that fit into some minutes, at least one; null for no valid time. */
export function generationsIn(minutes: number, { startup, each }: Pace): number | null {
  if (!Number.isFinite(minutes) || minutes <= 0) return null;
  return Math.max(1, Math.floor((60 * minutes - startup) / each));
}

/** Minutes with two digits. */
export const shownMinutes = (minutes: number): string => String(Number(minutes.toPrecision(2)));
