/** Colours of creatures: by fitness, or by the operator that made them, which also has a shape. */

import { type Phylogeny, NONE } from "../decode/phylogeny";
import type { Theme } from "../ui/canvas";
import { css, viridis } from "../ui/colours";

export type ColourBy = "fitness" | "operator";

/** Steps of fitness; one more shade is for creatures without one. */
const STEPS = 14;
const UNKNOWN = { light: "#7b8b95", dark: "#7d909c" };
/** Okabe and Ito's colours for all kinds of sight, on light and dark water. */
const KINDS = {
  light: ["#0b6b62", "#b34a00", "#2f6fb3", "#9a3f7d", "#7a5f00", "#3f4d57"],
  dark: ["#6fd3c0", "#f2a15f", "#8cc0f0", "#e59ccb", "#e8d36a", "#b8c6cf"],
};
export const SHAPES = ["circle", "square", "diamond", "triangle"] as const;
/** Operators with colours of their own, the same in every tree; others take those that follow. */
const KNOWN = ["neat", "random", "crossover", "fork", "iso+line", "copy"];
export type Shape = (typeof SHAPES)[number];

export interface Shades {
  by: ColourBy;
  /** Colours by shade; the last stands for what is unknown. */
  colours: string[];
  /** The shade of each creature. */
  shade: Uint8Array;
  /** Lowest and highest fitness. */
  range: [number, number];
}

export function shadesOf(tree: Phylogeny, by: ColourBy, theme: Theme): Shades {
  const range = rangeOf(tree.fitness);
  const colours =
    by === "fitness" ? fitnessColours(theme) : tree.operators.map((_, i) => operatorColour(tree, i, theme));
  const unknown = colours.length;
  const span = range[1] - range[0] || 1;
  const shade = Uint8Array.from({ length: tree.count }, (_, i) => {
    if (by === "operator") return tree.operator[i] === NONE ? unknown : tree.operator[i]!;
    const value = tree.fitness[i]!;
    return Number.isFinite(value) ? Math.round(((value - range[0]) / span) * (STEPS - 1)) : unknown;
  });
  return { by, colours: [...colours, UNKNOWN[theme]], shade, range };
}

function rangeOf(fitness: Float64Array): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const value of fitness) {
    if (!Number.isFinite(value)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return low > high ? [0, 1] : [low, high];
}

const fitnessColours = (theme: Theme) =>
  Array.from({ length: STEPS }, (_, i) => fitnessColour(i / (STEPS - 1), theme));

/** Viridis without the end that the background hides. */
export const fitnessColour = (share: number, theme: Theme) =>
  css(viridis(theme === "dark" ? 0.2 + 0.8 * share : 0.88 * share));

function kindOf({ operators }: Pick<Phylogeny, "operators">, operator: number): number {
  const known = KNOWN.indexOf(operators[operator]!);
  return known >= 0 ? known : KNOWN.length + operator;
}

export const operatorColour = (tree: Pick<Phylogeny, "operators">, operator: number, theme: Theme) =>
  KINDS[theme][kindOf(tree, operator) % KINDS[theme].length]!;

export const shapeOf = (tree: Pick<Phylogeny, "operators">, operator: number): Shape =>
  operator === NONE ? "circle" : SHAPES[kindOf(tree, operator) % SHAPES.length]!;

/** The radius of a dot in pixels: fitness has a size too, so that colour is not its only sign. */
export function radiusOf({ by, shade, colours }: Shades, i: number): number {
  if (by === "operator" || shade[i] === colours.length - 1) return 3.4;
  return 2.2 + (2.6 * shade[i]!) / (STEPS - 1);
}
