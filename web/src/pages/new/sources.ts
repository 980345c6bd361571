/** What a new run can begin from, as the address names it. */

import * as api from "../../api/client";
import { messageOf } from "../../api/problem";
import type { Experiment, Preset, Spec } from "../../api/types";
import type { Address, Base } from "../../live/draft";
import { completed } from "../../view/form/completing";
import { isSearch, withOrigin } from "../../view/form/forking";
import { type Found, specOf } from "../../view/form/reading";
import { short } from "../../view/format";

export function addressed(query: URLSearchParams): Address | null {
  const word = ["fork", "begin", "from", "creature", "preset"].find((name) => query.get(name));
  if (!word) return null;
  const creature = word === "fork" ? query.get("creature") : null;
  return creature ? [word, query.get(word)!, creature] : [word, query.get(word)!];
}

export function ofPreset(preset: Preset, { experiment }: Experiment): Base {
  return { kind: "preset", name: `${experiment}/${preset.name}`, spec: preset.spec };
}

/** What the address names; throws what a person can read where there is no such thing. */
export async function load(
  [word, name, creature]: Address,
  experiments: Experiment[],
): Promise<Base> {
  if (word === "preset") return named(name, experiments);
  try {
    if (word === "begin") return await begunFrom(name, experiments);
    if (word === "fork") return await forkOf(name, creature ?? null, experiments);
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

/** A search that begins from one creature, in its world. */
async function begunFrom(sha: string, experiments: Experiment[]): Promise<Base> {
  const spec = whole(specOf(await api.readCreature(sha)), experiments);
  if (!isSearch(spec)) throw new Error("no search can begin from it.");
  const fork = { run: null, creature: sha, creatures: 1 };
  return { kind: "creature", name: sha, spec: withOrigin(spec, [sha]), fork };
}

/** A run's spec, to begin from one creature or from all its elites. */
async function forkOf(id: string, creature: string | null, experiments: Experiment[]): Promise<Base> {
  const run = await api.readRun(id);
  if (!isSearch(run.spec)) {
    if (creature) return begunFrom(creature, experiments);
    throw new Error("it fills no archive to begin from.");
  }
  const creatures = creature ? 1 : (await api.readArchive(id)).creature.length;
  const spec = withOrigin(whole(run.spec, experiments), []);
  return { kind: "run", name: id, spec, fork: { run: id, creature, creatures } };
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
