/** Every elite that ever entered an archive, and the archive of each generation. */

import type { History } from "../api/types";
import { type Elite, type Elites, eliteAt } from "./elites";

/** The elites after a generation; forward, only those that came since are looked at. */
export function walkThrough(history: History): (generation: number) => Elites {
  const { elite_generation: told } = history;
  let elites: Elites = new Map();
  let [next, shown] = [0, 0];
  return (generation) => {
    const later: Map<number, Elite> = generation < shown ? new Map() : new Map(elites);
    if (generation < shown) next = 0;
    for (; next < told.length && told[next]! <= generation; next++) {
      later.set(history.cell[next]!, eliteAt(history, next, told[next]!));
    }
    [elites, shown] = [later, generation];
    return elites;
  };
}
