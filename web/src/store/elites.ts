/** The elite in each cell, from snapshots and changes. */

import type { Archive, ArchiveColumns } from "../api/types";

export interface Elite {
  fitness: number;
  descriptors: number[];
  generation: number;
  creature: string;
  /** The generation that told of it. */
  seenAt: number;
}

export type Elites = ReadonlyMap<number, Elite>;

/** The elites after an event: columns of changed cells, and the generation it tells of. */
export function withElites(elites: Elites, { generation, ...columns }: CellColumns): Elites {
  const next = new Map(elites);
  columns.cell.forEach((cell, i) => next.set(cell, eliteAt(columns, i, generation)));
  return next;
}

type CellColumns = ArchiveColumns & { generation: number };

/** A snapshot, and what events told of later generations while it was on its way. */
export function mergeElites(archive: Archive, known: Elites): Elites {
  const next = new Map<number, Elite>();
  archive.cell.forEach((cell, i) => {
    next.set(cell, eliteAt(archive, i, archive.elite_generation[i]!));
  });
  for (const [cell, elite] of known) {
    if (elite.seenAt > archive.generation) next.set(cell, elite);
  }
  return next;
}

export function truncateElites(elites: Elites, generation: number): Elites {
  return new Map([...elites].filter(([, elite]) => elite.seenAt <= generation));
}

export function eliteAt(columns: ArchiveColumns, i: number, told: number): Elite {
  return {
    fitness: columns.fitness[i]!,
    descriptors: columns.descriptors[i]!,
    generation: columns.elite_generation[i]!,
    creature: columns.creature[i]!,
    seenAt: told,
  };
}
