/** A spec as sections of fields, with their differences from a preset. */

import type { Json, Preset, Spec } from "../../api/types";
import { words } from "../../ui/format";
import { type Difference, differences, valueText } from "./difference";
import { text } from "./text";

/** Characters of a value that are shown; pictures have thousands. */
const MAX_LENGTH = 120;

interface Field {
  path: string;
  name: string;
  text: string;
  /** The value of the preset; null if it is the same. */
  presetValue: string | null;
}

/** The preset with the fewest differences from a spec, whatever the seed. */
export function nearestPreset(spec: Spec, presets: readonly Preset[]) {
  const seedless = (other: Spec) => ({ ...other, seed: spec.seed ?? null });
  const found = presets.map((preset) => ({
    preset,
    changed: differences([seedless(preset.spec), { seed: null, ...spec }]),
  }));
  return found.sort((a, b) => a.changed.length - b.changed.length)[0] ?? null;
}

/** One section for each part of the spec; fields that are no part come first. */
export function sectionsOf(spec: Spec, changed: readonly Difference[]) {
  const presetValue = new Map(changed.map(({ path, values }) => [path, values[0]]));
  const sections = new Map<string, Field[]>([["", []]]);
  for (const { path, values } of differences([{}, spec])) {
    const [head, ...rest] = path.split(".");
    const title = rest.length > 0 ? head! : "";
    if (!sections.has(title)) sections.set(title, []);
    sections.get(title)!.push({
      path,
      name: nameOf(rest.length > 0 ? rest : [head!]),
      text: brief(values[1]),
      presetValue: presetValue.has(path) ? brief(presetValue.get(path)) : null,
    });
  }
  return [...sections]
    .filter(([, fields]) => fields.length > 0)
    .map(([title, fields]) => ({ title: title ? words(title) : text.run, fields }));
}

/** `descriptors.0.bins` as `Descriptors 1, bins`. */
export function nameOf(parts: readonly string[]): string {
  const text = parts.map((part) => (/^\d+$/.test(part) ? ` ${Number(part) + 1}` : `, ${part}`)).join("");
  return words(text.replace(/^, /, "").trim());
}

export function brief(value: Json | undefined): string {
  const text = valueText(value);
  return text.length > MAX_LENGTH ? `${text.slice(0, MAX_LENGTH)} …` : text;
}
