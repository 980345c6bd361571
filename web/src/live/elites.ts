/** The elite in each cell, from snapshots and changes. */

import type { Archive, ArchiveColumns } from "../api/types";

export interface Elite {
  fitness: number;
  descriptors: number[];
  generation: number;
  creature: string;
}

export type Elites = ReadonlyMap<number, Elite>;

export function withElites(elites: Elites, columns: ArchiveColumns): Elites {
  const next = new Map(elites);
  columns.cell.forEach((cell, i) => next.set(cell, eliteAt(columns, i)));
  return next;
}

/** A snapshot, and what events told of later generations while it was on its way. */
export function mergeElites(archive: Archive, known: Elites): Elites {
  const next = new Map(withElites(new Map(), archive));
  for (const [cell, elite] of known) {
    if (elite.generation > archive.generation) next.set(cell, elite);
  }
  return next;
}

export function cutElites(elites: Elites, generation: number): Elites {
  return new Map([...elites].filter(([, elite]) => elite.generation <= generation));
}

function eliteAt(columns: ArchiveColumns, i: number): Elite {
  return {
    fitness: columns.fitness[i]!,
    descriptors: columns.descriptors[i]!,
    generation: columns.elite_generation[i]!,
    creature: columns.creature[i]!,
  };
}
