/** Formats of numbers, times and names. */

import type { Experiment, Run, Spec } from "../api/types";
import { canonical } from "../decode/canonical";
import { text } from "./text";

export const DASH = "–";

export function number(value: number | null | undefined, digits = 3): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return DASH;
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) return scientific(value, digits - 1);
  const wholeDigits = Math.floor(Math.log10(Math.max(size, 1))) + 1;
  const maximumSignificantDigits = Math.max(digits, wholeDigits);
  return plain(value, { maximumSignificantDigits }).replace("-", "−");
}

/** In the language of the page; without the sign of −0. */
const plain = (value: number, options = {}) => (value === 0 ? 0 : value).toLocaleString("en", options);

const SUPERSCRIPT: Record<string, string> = Object.fromEntries(
  [..."-0123456789"].map((digit, i) => [digit, [..."⁻⁰¹²³⁴⁵⁶⁷⁸⁹"][i]!]),
);

export function scientific(value: number, digits = 1): string {
  const [mantissa, exponent] = value.toExponential(digits).split("e") as [string, string];
  const power = [...exponent.replace("+", "")].map((digit) => SUPERSCRIPT[digit]).join("");
  const plain = String(Number(mantissa)).replace("-", "−");
  return plain === "1" ? `10${power}` : `${plain} × 10${power}`;
}

export function count(value: number | null | undefined): string {
  return value == null ? DASH : plain(Math.round(value));
}

export function bytes(value: number): string {
  const units = ["B", "kB", "MB", "GB", "TB"];
  const i = Math.min(units.length - 1, Math.floor(Math.log10(Math.max(1, value)) / 3));
  return `${number(value / 1000 ** i)} ${units[i]}`;
}

export function percent(value: number | null | undefined): string {
  if (value == null) return DASH;
  const hundredths = 100 * value;
  return `${number(value < 1 ? Math.min(hundredths, 99.9) : hundredths)} %`; // 100 % is all of it.
}

export function duration(seconds: number | null): string {
  if (seconds === null || !Number.isFinite(seconds)) return DASH;
  if (seconds < 1) return text.underOneSecond;
  const s = Math.round(seconds);
  if (s < 60) return `${s} s`;
  if (s < 3600) return `${Math.floor(s / 60)} min ${s % 60} s`;
  if (s < 86400) return `${Math.floor(s / 3600)} h ${Math.floor((s % 3600) / 60)} min`;
  return `${Math.floor(s / 86400)} d ${Math.floor((s % 86400) / 3600)} h`;
}

export function dateTime(iso: string): string {
  const options = { dateStyle: "medium", timeStyle: "short" } as const;
  return new Date(iso).toLocaleString(undefined, options);
}

export const inDays = (days: number, now: number) => new Date(now + days * 86_400_000).toISOString();

export function shortId(id: string): string {
  return id.slice(0, 8);
}

export const capitalised = (text: string) => text.charAt(0).toUpperCase() + text.slice(1);

/** `bending_effort` as words. */
export const words = (name: string) => capitalised(name.replaceAll("_", " "));

/** The name of a run, or of its preset with any seed, or of its experiment. */
export function titleOf(run: Run, experiments: Experiment[]): string {
  const label = labelOf(run);
  if (run.name || run.demonstration) return label;
  const presets = experiments.find(({ experiment }) => experiment === run.experiment)?.presets;
  const preset = presets?.find(({ spec }) => seedless(spec) === seedless(run.spec));
  if (!preset) return label;
  // Most runs are searches, for which the preset alone is enough.
  return run.experiment === "quality-diversity" ? words(preset.name) : `${label}, ${preset.name}`;
}

/** The title of a run whose spec is not known. */
export function labelOf(run: Pick<Run, "name" | "experiment" | "demonstration">): string {
  if (run.name) return run.name;
  return run.demonstration ? text.demonstration : words(run.experiment.replaceAll("-", " "));
}

const SEEDLESS = new WeakMap<Spec, string>();

/** The JSON of a spec without its seed, cached because lists ask for it often. */
function seedless(spec: Spec): string {
  const known = SEEDLESS.get(spec);
  if (known !== undefined) return known;
  const json = canonical({ ...spec, seed: 0 });
  SEEDLESS.set(spec, json);
  return json;
}
