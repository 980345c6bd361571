/** Titles, units and groups of measures, from the server's table. */

import table from "../api/measures.json";
import { number, percent, words } from "./format";

/** The title and unit of a measure; plug-ins declare their own. */
export interface Titled {
  title: string;
  unit: string;
}

interface Declared extends Titled {
  group: string;
  about: string;
}

const MEASURES: Record<string, Declared | undefined> = table.measures;

/** Keys and titles of the groups of measures, in order. */
export const GROUPS = table.groups as [key: string, title: string][];

/** The group of a measure; those of plug-ins belong to the first. */
export const groupOf = (name: string) => MEASURES[name]?.group ?? GROUPS[0]![0];

/** The title of a measure; an unknown one has its name in words. */
export const titleOf = (name: string, plugin?: Titled) => (MEASURES[name] ?? plugin)?.title ?? words(name);

/** The meaning of the measure with this title, as plain text. */
export const aboutOf = (title: string) => {
  const known = Object.values(MEASURES).find((measure) => measure?.title === title);
  return known?.about.replaceAll("`", "");
};

/** A value of a measure with its unit. */
export function valueOf(name: string, value: number, plugin?: Titled): string {
  const unit = (MEASURES[name] ?? plugin)?.unit;
  if (unit === "share") return percent(value);
  return unit ? `${number(value, 6)} ${unit}` : number(value, 6);
}
