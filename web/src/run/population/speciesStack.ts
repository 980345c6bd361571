/** Species over the generations as stacked areas. */

import type { SpeciesHistory } from "../../api/types";
import { css, viridis } from "../../ui/colours";

interface Area {
  number: number;
  /** Lower and upper edge in each generation, from 0 to the size of the population. */
  from: number[];
  to: number[];
}

export interface Stack {
  generation: readonly number[];
  areas: Area[];
  size: number;
}

/** The oldest species are at the bottom, so that a living species keeps its neighbours. */
export function stackOf({ generation, number, members }: SpeciesHistory): Stack {
  const sizes = number.map((row, i) => new Map(row.map((each, k) => [each, members[i]![k]!])));
  const all = [...new Set(number.flat())].sort((a, b) => a - b);
  const tops = generation.map(() => 0);
  const areas = all.map((each) => {
    const from = [...tops];
    sizes.forEach((size, i) => (tops[i]! += size.get(each) ?? 0));
    return { number: each, from, to: [...tops] };
  });
  return { generation, areas, size: Math.max(1, ...tops) };
}

/** The golden section makes the lightness of successive species differ most. */
const GOLDEN = 0.61803398875;

/** The viridis colour of a species, which stays the same in every plot. */
export function colourOf(number: number): string {
  return css(viridis(0.08 + 0.88 * ((number * GOLDEN) % 1)));
}

/** Number and size of the species at a height in a generation. */
export function speciesAt(stack: Stack, i: number, height: number): [number, number] | null {
  const area = stack.areas.find(({ from, to }) => height >= from[i]! && height < to[i]!);
  return area ? [area.number, area.to[i]! - area.from[i]!] : null;
}

/** The outline of an area, along its upper edge and back along its lower edge. */
export function pathOf({ from, to }: Area, x: (i: number) => number, y: (v: number) => number): string {
  const [first, last] = extentOf({ from, to });
  const there = range(first, last).map((i) => `${x(i).toFixed(1)} ${y(to[i]!).toFixed(1)}`);
  const back = range(first, last).map((i) => `${x(i).toFixed(1)} ${y(from[i]!).toFixed(1)}`);
  return `M${there.join("L")}L${back.reverse().join("L")}Z`;
}

/** First and last generation of the outline: one before the species and one after. */
export function extentOf({ from, to }: Pick<Area, "from" | "to">): [first: number, last: number] {
  const alive = to.map((top, i) => top > from[i]!);
  return [Math.max(0, alive.indexOf(true) - 1), Math.min(to.length - 1, alive.lastIndexOf(true) + 1)];
}

const range = (first: number, last: number) => Array.from({ length: last - first + 1 }, (_, k) => first + k);
