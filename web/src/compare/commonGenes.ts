/** Genes that networks of NEAT have in common. */

import type { Creature } from "../api/types";
import { DASH } from "../ui/format";
import { text } from "./text";

/**
 * For each creature, how many of its connections the first one has too: those with equal innovation
 * numbers, which come from one ancestor. Null if the first one has no such genes.
 */
export function commonGenes([first, ...others]: Creature[]): string[] | null {
  const own = first && innovationsOf(first);
  if (!own || others.length === 0) return null;
  const known = new Set(own);
  return [first, ...others].map((creature) => {
    const genes = innovationsOf(creature);
    return genes ? text.of(genes.filter((gene) => known.has(gene)).length, genes.length) : DASH;
  });
}

function innovationsOf({ identity: { genome } }: Creature): number[] | null {
  return "connections" in genome ? genome.connections.innovation : null;
}
