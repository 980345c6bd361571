/** Creatures chosen in a run, from which the next generations descend. */

import * as api from "../api/client";
import { sharedSlug } from "../api/address";
import type { Choices, Run } from "../api/types";
import { SLOW_MS, useFetched } from "./fetch";
import { useThrottled } from "./polling";
import { epochOf } from "./state";
import { currentState, update, useStore } from "./store";
import { offerUndo, orShowError, showToast } from "./toasts";
import { text } from "./text";

export const MAX_CHOSEN = 64;

const keep = (id: string, choices: Choices) =>
  update((state) => ({ ...state, choices: new Map(state.choices).set(id, choices) }));

/** The choices of a run, once `useChoices` has loaded them. */
export const useKnownChoices = (id: string): Choices | undefined =>
  useStore((state) => state.choices.get(id));

/** Load the choices of a run, and again when they may have changed. */
export function useChoices(run: Run | undefined): Choices | undefined {
  const { id = "", generation = 0, status, experiment } = run ?? {};
  const choices = useKnownChoices(id);
  const epoch = useStore((state) => epochOf(state, id));
  const slow = useThrottled(generation, SLOW_MS);
  // A choice that waits counts with the next generation.
  const newest = choices?.items.some((choice) => choice.generation === null) ? generation : slow;
  useFetched(async () => {
    if (experiment === "quality-diversity" && !sharedSlug) keep(id, await api.readChoices(id));
  }, [id, experiment, epoch, status, newest]);
  return choices;
}

/** Choose creatures, and offer to take them back; return true on success. */
export async function choose(id: string, creatures: string[]): Promise<boolean> {
  const known = currentState().choices.get(id) ?? (await orShowError(api.readChoices(id)));
  const choices = known && (await orShowError(api.chooseCreatures(id, creatures)));
  if (!choices) return false;
  keep(id, choices);
  const added = withoutWaiting(creatures, known);
  const note = text.chosen(creatures.length);
  if (added.length > 0) offerUndo(note, () => void takeBack(id, added));
  else showToast({ kind: "note", text: note });
  return true;
}

/** Creatures that no earlier choice has yet: Undo takes these back alone. */
export function withoutWaiting(creatures: readonly string[], { items }: Choices): string[] {
  const waiting = items.filter(({ generation }) => generation === null);
  return creatures.filter((name) => !waiting.some(({ creature }) => creature === name));
}

export async function takeBack(id: string, creatures: string[]): Promise<void> {
  const choices = await orShowError(api.takeBackChoices(id, creatures));
  if (choices) keep(id, choices);
}

/** True while a run may have another generation to begin. */
export const goesOn = ({ status }: Run) => ["queued", "running", "paused"].includes(status);

export interface Group {
  /** The first generation that descends from them; null until it begins. */
  generation: number | null;
  creatures: string[];
}

/** Choices by generation, the newest first. */
export function groupsOf({ items }: Choices): Group[] {
  const groups = new Map<number | null, string[]>();
  for (const { generation, creature } of items) {
    groups.set(generation, [...(groups.get(generation) ?? []), creature]);
  }
  return [...groups].map(([generation, creatures]) => ({ generation, creatures })).reverse();
}
