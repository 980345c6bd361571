/** What a new run can begin from, as the address names it. */

import * as api from "../../api/client";
import { messageOf } from "../../api/problem";
import type { Experiment, Preset, Spec } from "../../api/types";
import type { Base } from "../../live/draft";
import { completed } from "../../view/form/completing";
import { type Found, specOf } from "../../view/form/reading";
import { short } from "../../view/format";

export function addressed(query: URLSearchParams): [string, string] | null {
  const word = ["from", "creature", "preset"].find((name) => query.get(name));
  return word ? [word, query.get(word)!] : null;
}

export function ofPreset(preset: Preset, { experiment }: Experiment): Base {
  return { kind: "preset", name: `${experiment}/${preset.name}`, spec: preset.spec };
}

/** What the address names; throws what a person can read where there is no such thing. */
export async function load(
  [word, name]: [string, string],
  experiments: Experiment[],
): Promise<Base> {
  if (word === "preset") return named(name, experiments);
  try {
    if (word === "creature") {
      const spec = specOf(await api.readCreature(name));
      return { kind: "creature", name, spec: whole(spec, experiments) };
    }
    const run = await api.readRun(name);
    return { kind: "run", name, spec: whole(run.spec, experiments) };
  } catch (error) {
    throw new Error(`“${word}” in the address names ${name}: ${messageOf(error)}`);
  }
}

function named(name: string, experiments: Experiment[]): Base {
  const all = experiments.flatMap((one) => one.presets.map((preset) => ofPreset(preset, one)));
  const found = all.find((base) => base.name === name);
  if (found) return found;
  const known = all.map((base) => base.name).join(", ");
  throw new Error(`“preset” in the address must be one of ${known}; got ${name}.`);
}

/** The spec with the defaults of what it leaves out. */
export function whole(spec: Spec, experiments: Experiment[]): Spec {
  const own = experiments.find(({ experiment }) => experiment === spec.experiment);
  if (own) return completed(own.schema, spec);
  const known = experiments.map(({ experiment }) => experiment).join(", ");
  throw new Error(`“experiment” must be one of ${known}; got ${String(spec.experiment)}.`);
}

/** What was pasted or dropped, as something to begin from. */
export function ofFound(found: Found, file: string, experiments: Experiment[]): Base {
  const given = { spec: whole(found.spec, experiments), foreign: true };
  if (found.kind === "creature") return { ...given, kind: "creature", name: found.creature.sha256 };
  if (found.kind === "run" && found.id) return { ...given, kind: "run", name: found.id };
  return { ...given, kind: "pasted", name: file };
}

export function titleOfBase({ kind, name }: Base): string {
  if (kind === "preset") return `preset “${name.split("/")[1]}”`;
  if (kind === "run") return `run ${short(name)}`;
  if (kind === "creature") return `creature ${short(name)}`;
  return name || "what was pasted";
}
