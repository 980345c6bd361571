/** Sources of a new run: presets, runs and creatures that the address names, and documents. */

import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Experiment, Preset, Spec, Creature, Json, Gait } from "../api/types";
import {
  type Address,
  type Base,
  type ForkSource,
  parseCells,
  parseCreatures,
  FORK_PARAMETERS,
  forkAddress,
} from "../store/draft";
import { withDefaults } from "./form/schema";
import { isSearch, withInitial } from "./initialCreatures";
import { count, shortId } from "../ui/format";
import { text } from "./text";
import { isObject } from "../run/spec/difference";
import { parseJson } from "../decode/json";

/** The largest number of initial creatures, as in the schema of `search.initial`. */
export const MAX_CREATURES = 4096;

export function sourceAddress(query: URLSearchParams): Address | null {
  const parameter = ["fork", "initial", "from", "creature", "preset"].find((name) => query.get(name));
  if (!parameter) return null;
  const name = query.get(parameter)!;
  if (parameter !== "fork") return [[parameter, name]];
  return forkAddress(name, Object.fromEntries(FORK_PARAMETERS.map((each) => [each, query.get(each)])));
}

export function baseOfPreset(preset: Preset, { experiment }: Experiment): Base {
  return { kind: "preset", name: `${experiment}/${preset.name}`, spec: preset.spec };
}

/** Load the source that the address names; throw a readable error if there is none. */
export async function load(address: Address, experiments: Experiment[]): Promise<Base> {
  const [parameter, name] = address[0]!;
  if (parameter === "preset") return presetBase(name, experiments);
  try {
    if (parameter === "initial") return await creatureBase(name, experiments);
    if (parameter === "fork") return await forkBase(name, Object.fromEntries(address), experiments);
    if (parameter === "creature") {
      const spec = specOf(await api.readCreature(name));
      return { kind: "creature", name, spec: completeSpec(spec, experiments) };
    }
    const run = await api.readRun(name);
    return { kind: "run", name, spec: completeSpec(run.spec, experiments) };
  } catch (error) {
    throw new Error(text.badAddress(parameter, name, messageOf(error)));
  }
}

/** A search that starts from one creature, in its world. */
async function creatureBase(sha: string, experiments: Experiment[]): Promise<Base> {
  const spec = completeSpec(specOf(await api.readCreature(sha)), experiments);
  if (!isSearch(spec)) throw new Error(text.notEvolvable);
  const fork = { run: null, named: [sha], cells: null, at: null, creatures: 1 };
  return { kind: "creature", name: sha, spec: withInitial(spec, [sha]), fork };
}

/** The spec of a run, starting from one creature or from elites: all, or those of some cells. */
async function forkBase(
  id: string,
  { creature, cells, at }: Record<string, string>,
  experiments: Experiment[],
): Promise<Base> {
  const run = await api.readRun(id);
  const named = creature ? parseCreatures(creature) : null;
  if (!isSearch(run.spec)) {
    if (named) return creatureBase(named[0]!, experiments);
    throw new Error(text.noArchive);
  }
  const spec = withInitial(completeSpec(run.spec, experiments), []);
  const chosen = named && { run: id, named, cells: null, at: null, creatures: named.length };
  const asked = generationOf(at);
  // The run may have gone back behind a generation that an older address names.
  const known = asked === null ? null : Math.min(asked, run.generation);
  const fork = chosen ?? (await forkSource(id, cells ?? null, known));
  return { kind: "run", name: id, spec, fork };
}

async function forkSource(run: string, cells: string | null, at: number | null): Promise<ForkSource> {
  const { cell, creature, generation } = await api.readArchive(run, [], { generation: at ?? undefined });
  const selected = cells === null ? () => true : parseCells(cells);
  const indices = [...cell.keys()].filter((i) => selected(cell[i]!));
  if (indices.length === 0) throw new Error(text.noElites);
  const creatures = new Set(indices.map((i) => creature[i]!)).size;
  if (creatures > MAX_CREATURES) {
    throw new Error(text.tooMany(count(MAX_CREATURES), count(creatures)));
  }
  const filled = cells === null ? null : indices.map((i) => cell[i]!);
  return { run, named: null, cells: filled, at: at === null ? null : generation, creatures };
}

function generationOf(at: string | undefined): number | null {
  if (at === undefined) return null;
  if (/^\d+$/.test(at)) return Number(at);
  throw new Error(text.badGeneration(at));
}

function presetBase(name: string, experiments: Experiment[]): Base {
  const all = experiments.flatMap((one) => one.presets.map((preset) => baseOfPreset(preset, one)));
  const base = all.find((one) => one.name === name);
  if (base) return base;
  const known = all.map((base) => base.name).join(", ");
  throw new Error(text.badPreset(known, name));
}

export function completeSpec(spec: Spec, experiments: Experiment[]): Spec {
  const experiment = experiments.find((one) => one.experiment === spec.experiment);
  if (experiment) return withDefaults(experiment.schema, spec);
  const known = experiments.map(({ experiment }) => experiment).join(", ");
  throw new Error(text.badExperiment(known, String(spec.experiment)));
}

export function baseOfDocument(read: ReadDocument, file: string, experiments: Experiment[]): Base {
  const given = { spec: completeSpec(read.spec, experiments), fromDocument: true };
  if (read.kind === "creature") return { ...given, kind: "creature", name: read.creature.sha256 };
  if (read.kind === "run" && read.id) return { ...given, kind: "run", name: read.id };
  return { ...given, kind: "pasted", name: file };
}

export function titleOfBase({ kind, name }: Base): string {
  if (kind === "preset") return text.preset(name.split("/")[1]);
  if (kind === "run") return text.runOf(shortId(name));
  if (kind === "creature") return text.creature(shortId(name));
  return name || text.pastedSpec;
}

type ReadDocument =
  | { kind: "spec"; spec: Spec }
  | { kind: "run"; spec: Spec; id: string }
  | { kind: "creature"; spec: Spec; creature: Creature };

/** Read a text; throw an `Error` that names the accepted documents. */
export function readText(document: string, refine = false): ReadDocument {
  if (/^[\u0089\ufffd]HDF/.test(document)) throw new Error(text.noHdf5);
  return readDocument(parsed(document), refine);
}

function parsed(document: string): Json {
  try {
    return parseJson(document);
  } catch (error) {
    throw new Error(text.noJson((error as Error).message));
  }
}

export function readDocument(document: Json, refine = false): ReadDocument {
  if (!isObject(document)) throw new Error(text.notADocument(describe(document)));
  const { identity, spec, id } = document;
  if (isObject(identity)) {
    const creature = document as unknown as Creature;
    const made = refine ? { experiment: "refinement", creature: document } : specOf(creature);
    return { kind: "creature", creature, spec: made };
  }
  if (isObject(spec))
    return { kind: "run", spec: checkedSpec(spec, "spec.experiment"), id: String(id ?? "") };
  return { kind: "spec", spec: checkedSpec(document, "experiment") };
}

function checkedSpec(spec: Spec, field: string): Spec {
  if (typeof spec.experiment === "string") return spec;
  throw new Error(text.noExperiment(field, describe(spec.experiment)));
}

function describe(value: Json | undefined): string {
  if (value === undefined) return text.nothing;
  if (Array.isArray(value)) return text.list;
  return value === null ? "null" : `${typeof value} ${JSON.stringify(value).slice(0, 40)}`;
}

/** A run in a creature's world, with its body, coupling, controller and task. */
function specOf(creature: Creature): Spec {
  const { genome, body, task } = creature.identity;
  const { coupling, ...world } = creature.identity.world as Spec & { coupling: Json };
  if (genome.encoding === "gait") return gaitSpec(genome, world);
  const scene = { world, body, coupling };
  const control = { ...genome.control, encoding: genome.encoding };
  if (genome.encoding === "fold") return foldSpec({ ...scene, control }, world, task);
  const room = roomOf(creature);
  return {
    experiment: "quality-diversity",
    ...scene,
    control,
    ...(room && { genome: room }),
    task,
    // NEAT's mutations do not vary numeric genes.
    ...((genome.encoding === "direct" || isPlugin(genome.encoding)) && {
      search: { emitters: [{ operator: "iso+line" }] },
    }),
  };
}

const isPlugin = (name: string) => name.includes(".");

/** The room for nodes and connections with which the creature was evaluated. */
function roomOf({ measured }: Creature): Spec | null {
  const room = (measured as { room?: [number, number] | null } | null)?.room;
  return room ? { max_nodes: room[0], max_connections: room[1] } : null;
}

function gaitSpec(stroke: Gait, world: Spec): Spec {
  return {
    experiment: "gaits",
    swimmers: [stroke.swimmer],
    ...(stroke.plugin && { plugins: { [stroke.swimmer]: stroke.plugin } }),
    viscosities: [world.viscosity ?? null],
    width: world.width ?? null,
    height: world.height ?? null,
    period: stroke.period,
    ramp: stroke.ramp,
    steric: world.steric ?? null,
  };
}

/** Pictures take up about two thirds of the world's shorter side, as in the presets. */
function foldSpec(scene: Spec, world: Spec, task: Spec): Spec {
  const size = Math.floor((2 / 3) * Math.min(Number(world.width), Number(world.height)));
  return { experiment: "folding", ...scene, steps: task.steps ?? null, size };
}
