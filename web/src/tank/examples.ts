/** Creatures that come with the page: they swim where no run has elites yet. */

import type { Tank } from "../api/types";
import { useFetched } from "../store/fetch";
import { openCreature } from "../ui/DropTarget";
import creaturesUrl from "./examples/creatures.json?url&no-inline";
import motionsUrl from "./examples/motions.poses?url&no-inline";

/** The fields of their creature files that the page reads. */
interface Example {
  sha256: string;
  measured: { fitness: number };
  provenance: { generation: number };
}

const read = async (url: string) => {
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`${url}: ${answer.status}`);
  return answer;
};

const creatures = async (): Promise<Example[]> => (await read(creaturesUrl)).json();

/** The tank of examples; null while it is loaded, and unless it is `wanted`. */
export function useExamples(wanted: boolean): Tank | null {
  return useFetched(async () => (wanted ? tankOf(await creatures()) : null), [wanted]).value;
}

const tankOf = (examples: Example[]): Tank => ({
  runs: [],
  swimmers: examples.map(({ sha256, measured, provenance }) => ({
    creature: sha256,
    run: "",
    fitness: measured.fitness,
    generation: provenance.generation,
  })),
});

export const readExampleBatch = async () => (await read(motionsUrl)).arrayBuffer();

/** Import an example, and show it as any other creature. */
export async function openExample(sha: string): Promise<void> {
  const found = (await creatures()).find(({ sha256 }) => sha256 === sha);
  await openCreature(new File([JSON.stringify(found)], sha, { type: "application/json" }));
}
