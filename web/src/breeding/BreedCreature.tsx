/** The button that chooses one creature, on its own page, while its run goes on. */

import * as api from "../api/client";
import { goesOn, takeBack, useChoices } from "../store/choices";
import { useFetched } from "../store/fetch";
import { applyResponse, useStore } from "../store/store";
import { BreedButton } from "./BreedButton";
import { text } from "./text";

export function BreedCreature({ run: id, creature }: { run: string; creature: string }) {
  const { error } = useFetched(() => applyResponse("response", api.readRun(id)), [id]);
  const run = useStore((state) => state.runs.get(id));
  const choices = useChoices(run);
  if (error || !run || !choices || choices.refusal || !goesOn(run)) return null;
  const waits = choices.items.some((one) => one.creature === creature && one.generation === null);
  if (!waits) return <BreedButton run={run} creatures={[creature]} />;
  return <button onClick={() => void takeBack(id, [creature])}>{text.takeBackChoice}</button>;
}
