/** What the spec was begun from, what was changed since, and the ways back. */

import { importCreature } from "../api/client";
import { messageOf } from "../api/problem";
import type { Experiment } from "../api/types";
import { formatCells } from "../store/cellRanges";
import type { Base, ForkSource, Draft } from "../store/draft";
import { showToast } from "../store/toasts";
import { navigate } from "../store/router";
import { equalPreset } from "./form/changes";
import { count, short } from "../ui/format";
import { titleOfBase } from "./sources";
import type { DraftState } from "./draftState";

/** A creature that came as a file, which this server need not know. */
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
    <p class="base-bar" role="status">
      <span>
        {draft.restored && "Your draft is back: "}
        {size === 0 ? "As in " : `${size} ${size === 1 ? "change" : "changes"} from `}
        <BaseName base={base} />
        {base.kind === "creature" && " with its world, body, coupling, controller and task"}
        {equal && `, the same as preset “${equal.name}”`}.
      </span>
      {base.fork && (
        <span class="base-fork">
          <ForkSourceText fork={base.fork} />
          <button type="button" class="plain" onClick={draft.dropFork}>
            Begin from random ones instead
          </button>
        </span>
      )}
      {size > 0 && (
        <button type="button" class="plain" onClick={draft.reset}>
          {draft.restored ? "Discard draft" : "Undo all changes"}
        </button>
      )}
      {file && base.name === file.sha && (
        <button type="button" class="plain" onClick={() => void open(file)}>
          Open this creature instead
        </button>
      )}
    </p>
  );
}

/** Whom the run begins from, with a way to them. */
function ForkSourceText({ fork: { run, creature, cells, at, creatures } }: { fork: ForkSource }) {
  const then = new URLSearchParams({
    ...(cells && { cells: formatCells(cells) }),
    ...(at !== null && { at: String(at) }),
  });
  const place = creature ? `/creatures/${creature}${run ? `?run=${run}` : ""}` : `/runs/${run}?${then}`;
  const which = creature ? ` ${short(creature)}` : "";
  return (
    <span>
      Begins from{" "}
      <a href={place}>
        {creatures === 1 ? "1 creature" : `${count(creatures)} creatures`}
        {which}
      </a>
      {run && (
        <>
          {" "}
          of <a href={`/runs/${run}`}>run {short(run)}</a>
        </>
      )}
      {at !== null && `, as they were after generation ${count(at)}`}.
    </span>
  );
}

const PAGES = { run: "runs", creature: "creatures" };

function BaseName({ base }: { base: Base }) {
  const page = PAGES[base.kind as keyof typeof PAGES];
  if (!page || base.foreign) return <b>{titleOfBase(base)}</b>;
  return <a href={`/${page}/${base.name}`}>{titleOfBase(base)}</a>;
}

async function open(file: CreatureFile): Promise<void> {
  try {
    const { creature } = await importCreature(new Blob([file.text], { type: "application/json" }));
    navigate(`/creatures/${creature}`);
  } catch (error) {
    showToast({ kind: "wrong", text: messageOf(error) });
  }
}
