/** The button that chooses creatures for the next generations to descend from. */

import type { Run } from "../api/types";
import { MAX_CHOSEN, choose, goesOn, useKnownChoices } from "../store/choices";
import { useRefusal } from "../store/principal";
import { showToast } from "../store/toasts";
import { text } from "./text";

interface Props {
  run: Run;
  creatures: string[];
  onChosen?: () => void;
}

/** Nothing where the run has ended or is somebody else's; a press says why a search refuses. */
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
