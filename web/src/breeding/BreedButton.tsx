/** The button that chooses creatures for the next generations to descend from. */

import type { Run } from "../api/types";
import { MAX_CHOSEN, choose, goesOn, useKnownChoices, takeBack, useChoices } from "../store/choices";
import { useRefusal } from "../store/principal";
import { showToast } from "../store/toasts";
import { text } from "./text";
import * as api from "../api/client";
import { useFetched } from "../store/fetch";
import { applyResponse, useStore } from "../store/store";

interface Props {
  run: Run;
  creatures: string[];
  onChosen?: () => void;
}

/** Hidden if the run has ended or belongs to somebody else; a press says why a search refuses. */
export function BreedButton({ run, creatures, onChosen }: Props) {
  const choices = useKnownChoices(run.id);
  const forbidden = useRefusal(run);
  if (!choices || forbidden || !goesOn(run)) return null;
  const refusal = creatures.length > MAX_CHOSEN ? text.tooMany(MAX_CHOSEN) : choices.refusal;
  const press = async () => {
    if (refusal) showToast({ kind: "wrong", text: refusal });
    else if (await choose(run.id, creatures)) onChosen?.();
  };
  return (
    <button
      class="primary"
      aria-disabled={refusal !== null}
      title={refusal ?? text.breedAbout}
      onClick={() => void press()}
    >
      {text.breed(creatures.length)}
    </button>
  );
}

/** The button that chooses one creature, on its own page, while its run goes on. */
export function BreedCreature({ run: id, creature }: { run: string; creature: string }) {
  const { error } = useFetched(() => applyResponse("response", api.readRun(id)), [id]);
  const run = useStore((state) => state.runs.get(id));
  const choices = useChoices(run);
  if (error || !run || !choices || choices.refusal || !goesOn(run)) return null;
  const waits = choices.items.some((one) => one.creature === creature && one.generation === null);
  if (!waits) return <BreedButton run={run} creatures={[creature]} />;
  return <button onClick={() => void takeBack(id, [creature])}>{text.takeBackChoice}</button>;
}
