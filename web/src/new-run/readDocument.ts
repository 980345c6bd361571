/** Read a pasted or dropped document: a spec, a run, or a creature. */

import type { Creature, Json, Spec, Gait } from "../api/types";
import { isObject } from "../run/spec/difference";
import { text } from "./text";

export type ReadDocument =
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
    return JSON.parse(document);
  } catch (error) {
    throw new Error(text.noJson((error as Error).message));
  }
}

/** The kind and the spec of a document; a creature becomes a search or a refinement. */
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

/** Encodings with numeric genes, which NEAT's mutations do not vary. */
const NUMERIC_ENCODINGS = ["direct", "weights"];

/** A run in a creature's world, with its body, coupling, controller and task. */
export function specOf(creature: Creature): Spec {
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
    ...((NUMERIC_ENCODINGS.includes(genome.encoding) || isPlugin(genome.encoding)) && {
      search: { emitters: [{ operator: "iso+line" }] },
    }),
  };
}

/** Names of plug-ins contain a dot. */
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
