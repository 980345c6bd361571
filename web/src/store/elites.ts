/** The elite in each cell, from snapshots, events and the history. */

import type { Archive, ArchiveColumns, History } from "../api/types";

export interface Elite {
  fitness: number;
  descriptors: number[];
  generation: number;
  creature: string;
  /** The verdict of its audit; null without one. */
  trusted: boolean | null;
  /** The generation whose event reported it. */
  reportedAt: number;
}

export type Elites = ReadonlyMap<number, Elite>;

/** The elites after an event with changed cells. */
export function withElites(
  elites: Elites,
  { generation, ...columns }: ArchiveColumns & { generation: number },
): Elites {
  const next = new Map(elites);
  columns.cell.forEach((cell, i) => next.set(cell, eliteAt(columns, i, generation)));
  return next;
}

/** A snapshot with later events that arrived before it. */
export function mergeElites(archive: Archive, known: Elites): Elites {
  const next = new Map<number, Elite>();
  archive.cell.forEach((cell, i) => {
    next.set(cell, eliteAt(archive, i, archive.elite_generation[i]!));
  });
  for (const [cell, elite] of known) {
    if (elite.reportedAt > archive.generation) next.set(cell, elite);
  }
  return next;
}

export function truncateElites(elites: Elites, generation: number): Elites {
  return new Map([...elites].filter(([, elite]) => elite.reportedAt <= generation));
}

/** A function from a generation to its elites; it is fastest if generations increase. */
export function elitesByGeneration(history: History): (generation: number) => Elites {
  const { elite_generation: entered } = history;
  let elites: Elites = new Map();
  let [next, shown] = [0, 0];
  return (generation) => {
    const later: Map<number, Elite> = generation < shown ? new Map() : new Map(elites);
    if (generation < shown) next = 0;
    for (; next < entered.length && entered[next]! <= generation; next++) {
      later.set(history.cell[next]!, eliteAt(history, next, entered[next]!));
    }
    [elites, shown] = [later, generation];
    return elites;
  };
}

function eliteAt(columns: ArchiveColumns, i: number, reportedAt: number): Elite {
  return {
    fitness: columns.fitness[i]!,
    descriptors: columns.descriptors[i]!,
    generation: columns.elite_generation[i]!,
    creature: columns.creature[i]!,
    trusted: columns.trusted?.[i] ?? null,
    reportedAt,
  };
}

export function fittest<K>(elites: Iterable<readonly [K, Elite]>): readonly [K, Elite] | null {
  let best: readonly [K, Elite] | null = null;
  for (const entry of elites) if (!best || entry[1].fitness > best[1].fitness) best = entry;
  return best;
}
