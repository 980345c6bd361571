/** The base of the spec, the number of changes, and undo. */

import type { Experiment } from "../api/types";
import { type Base, type ForkSource, type Draft, formatCells } from "../store/draft";
import { equalPreset } from "./form/document";
import { openCreature } from "../ui/DropTarget";
import { count, shortId } from "../ui/format";
import { titleOfBase } from "./sources";
import type { DraftState } from "./draftState";
import { text } from "./text";

export interface CreatureFile {
  sha: string;
  text: string;
}

interface Props {
  draft: DraftState;
  current: Draft;
  experiments: Experiment[];
  file: CreatureFile | null;
}

export function BaseBar({ draft, current, experiments, file }: Props) {
  const { base, spec } = current;
  const { size } = draft.changed;
  const equal = size > 0 || base.kind !== "preset" ? equalPreset(spec, experiments) : null;
  return (
    <p class="base-bar row" role="status">
      <span>
        {draft.restored && text.restoredDraft}
        {text.changes(size)} <BaseName base={base} />
        {base.kind === "creature" && text.ofCreature}
        {equal && text.equalPreset(equal.name)}.
      </span>
      {base.fork && (
        <span class="row">
          <ForkSourceText fork={base.fork} />
          <button type="button" class="plain" onClick={draft.dropFork}>
            {text.startRandom}
          </button>
        </span>
      )}
      {size > 0 && (
        <button type="button" class="plain" onClick={draft.reset}>
          {draft.restored ? text.discardDraft : text.undoAll}
        </button>
      )}
      {file && base.name === file.sha && (
        <button type="button" class="plain" onClick={() => void openCreature(jsonFile(file.text))}>
          {text.openCreature}
        </button>
      )}
    </p>
  );
}

function ForkSourceText({ fork: { run, named, cells, at, creatures } }: { fork: ForkSource }) {
  const then = new URLSearchParams({
    ...(cells && { cells: formatCells(cells) }),
    ...(at !== null && { at: String(at) }),
  });
  const creature = named?.length === 1 ? named[0]! : null;
  const place = creature ? `/creatures/${creature}${run ? `?run=${run}` : ""}` : `/runs/${run}?${then}`;
  const which = creature ? ` ${shortId(creature)}` : "";
  return (
    <span>
      {text.startsFrom}{" "}
      <a href={place}>
        {text.creatures(creatures)}
        {which}
      </a>
      {run && (
        <>
          {" "}
          {text.of} <a href={`/runs/${run}`}>{text.runOf(shortId(run))}</a>
        </>
      )}
      {at !== null && text.afterGeneration(count(at))}.
    </span>
  );
}

const jsonFile = (text: string) => new File([text], "", { type: "application/json" });

const PAGES = { run: "runs", creature: "creatures" };

function BaseName({ base }: { base: Base }) {
  const page = PAGES[base.kind as keyof typeof PAGES];
  if (!page || base.fromDocument) return <b>{titleOfBase(base)}</b>;
  return <a href={`/${page}/${base.name}`}>{titleOfBase(base)}</a>;
}
