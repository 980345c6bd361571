/** The elite in each cell, from snapshots, events and the history. */

import type { Archive, ArchiveColumns, ElitesEvent, History } from "../api/types";

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

/** A cell that lost its elite. */
interface Loss {
  creature: null;
  reportedAt: number;
}

/** The last change of each cell, from events. */
export type Changes = ReadonlyMap<number, Elite | Loss>;

/** The changes after an event. */
export function withChanges(changes: Changes, event: ElitesEvent): Changes {
  const next = new Map(changes);
  const reportedAt = event.generation;
  event.cell.forEach((cell, i) => next.set(cell, eliteAt(event, i, reportedAt)));
  for (const cell of event.emptied) next.set(cell, { creature: null, reportedAt });
  return next;
}

/** The elites after an event with changed cells. */
export const withElites = (elites: Elites, event: ElitesEvent): Elites =>
  applied(elites, withChanges(new Map(), event));

/** A snapshot with later events that arrived before it. */
export function mergeElites(archive: Archive, known: Changes): Elites {
  const snapshot = archive.cell.map(
    (cell, i) => [cell, eliteAt(archive, i, archive.elite_generation[i]!)] as const,
  );
  const later = [...known].filter(([, { reportedAt }]) => reportedAt > archive.generation);
  return applied(new Map(snapshot), new Map(later));
}

function applied(elites: Elites, changes: Changes): Elites {
  const next = new Map(elites);
  for (const [cell, elite] of changes) {
    if (elite.creature === null) next.delete(cell);
    else next.set(cell, elite);
  }
  return next;
}

/** The elites or changes that were reported up to a generation. */
export function truncateElites<E extends { reportedAt: number }>(
  elites: ReadonlyMap<number, E>,
  generation: number,
): ReadonlyMap<number, E> {
  return new Map([...elites].filter(([, { reportedAt }]) => reportedAt <= generation));
}

/** A function from a generation to its elites; it is fastest if generations increase. */
export function elitesByGeneration(history: History): (generation: number) => Elites {
  const { elite_generation: entered, emptied_generation: lost } = history;
  let elites: Elites = new Map();
  let [gains, losses, shown] = [0, 0, 0];
  return (generation) => {
    const later: Map<number, Elite> = generation < shown ? new Map() : new Map(elites);
    if (generation < shown) [gains, losses] = [0, 0];
    for (;;) {
      const [gain, loss] = [entered[gains] ?? Infinity, lost[losses] ?? Infinity];
      if (Math.min(gain, loss) > generation) break;
      if (loss < gain) later.delete(history.emptied[losses++]!);
      else later.set(history.cell[gains]!, eliteAt(history, gains++, gain));
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

/** Recorded measures by name and creature. */
export type Measures = ReadonlyMap<string, ReadonlyMap<string, number>>;

export function measuresOf({ creature, measures }: Pick<History, "creature" | "measures">): Measures {
  const columns = Object.entries(measures).map(([name, values]) => {
    const known = values.flatMap((value, i): [string, number][] =>
      value == null ? [] : [[creature[i]!, value]],
    );
    return [name, new Map(known)] as const;
  });
  return new Map(columns);
}

export function fittest<K>(elites: Iterable<readonly [K, Elite]>): readonly [K, Elite] | null {
  let best: readonly [K, Elite] | null = null;
  for (const entry of elites) if (!best || entry[1].fitness > best[1].fitness) best = entry;
  return best;
}
