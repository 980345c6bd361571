/** Trees for tests: by hand, and random ones of any size. */

import { type Phylogeny, NONE } from "../decode/phylogeny";

/** A creature: its time, then its parents as rows of earlier ones. */
type Row = readonly [time: number, ...parents: number[]];

export function treeOf(rows: readonly Row[]): Phylogeny {
  const count = rows.length;
  const links = rows.flatMap(([, ...parents], child) => parents.flatMap((parent) => [child, parent]));
  const creature = new Uint8Array(32 * count);
  rows.forEach((_, i) => new DataView(creature.buffer).setUint32(32 * i, i + 1));
  const time = Int32Array.from(rows, ([time]) => time);
  return {
    count,
    runs: ["first"],
    operators: ["neat", "random"],
    creature,
    links: Int32Array.from(links),
    run: new Int32Array(count),
    generation: time,
    lost: new Int32Array(count).fill(NONE),
    operator: Int32Array.from(rows, ([, ...parents]) => (parents.length > 0 ? 0 : 1)),
    time,
    fitness: Float64Array.from(rows, (_, i) => i),
  };
}

/** Births of a search: some in each generation, each with up to two parents among all earlier ones. */
export function grownTree(count: number, perGeneration = 50, seed = 1): Phylogeny {
  let state = seed;
  const draw = (below: number) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return Math.floor((state / 2 ** 32) * below);
  };
  const rows = Array.from({ length: count }, (_, i): Row => {
    const time = 1 + Math.floor(i / perGeneration);
    const earlier = (time - 1) * perGeneration;
    // Later creatures have children more often, as elites replace each other.
    const parent = () => Math.max(draw(earlier), draw(earlier));
    if (earlier === 0 || draw(200) === 0) return [time];
    return draw(3) === 0 ? [time, parent(), parent()] : [time, parent()];
  });
  return treeOf(rows);
}
