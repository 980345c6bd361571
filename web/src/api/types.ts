/** The words of the wire, under the names that the page uses. */

import type { components } from "./schema";

type Wire = components["schemas"];
/** A type of the server, with parts that OpenAPI can only call objects. */
type With<T, Parts> = Omit<T, keyof Parts> & Parts;

export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
export type Spec = { [key: string]: Json };
export type Schema = { [keyword: string]: Json };

export type Run = With<Wire["RunRead"], { spec: Spec }>;
export type RunPage = With<Wire["RunPage"], { items: Run[] }>;
export type Preset = With<Wire["PresetRead"], { spec: Spec }>;
export type Experiment = With<Wire["ExperimentRead"], { schema: Schema; presets: Preset[] }>;
export type Estimate = Wire["EstimateRead"];
export type Axis = Wire["Axis"];
export type Archive = Wire["ArchiveRead"];
export type ArchiveColumns = Omit<Archive, "generation" | "axes">;
export type Generations = Wire["Curves"];

export interface Genome {
  encoding: string;
  inputs: string[];
  outputs: string[];
  nodes: { id: number[]; activation: string[]; bias: string };
  connections: {
    innovation: number[];
    source: number[];
    target: number[];
    enabled: boolean[];
    weight: string;
  };
}

/** A creature file; one made elsewhere may know neither its figures nor its origin. */
export interface Creature {
  identity: {
    format: string;
    genome: Genome;
    world: Spec;
    body: Spec;
    task: Spec;
  };
  sha256: string;
  measured: {
    fitness: number;
    descriptors: { [name: string]: number };
    features: { [name: string]: number };
    block: number;
    device: string;
  } | null;
  provenance: {
    parents: string[];
    operator: string;
    generation: number;
    seed: number;
    version: string;
  } | null;
  licence: string;
}

/** What an error's body should be; something between page and server may answer otherwise. */
export type ProblemDocument = Partial<Wire["Problem"]>;
export type FieldError = Pick<Wire["FieldError"], "field" | "message">;

/** The last entry of each column of `Generations`. */
export type GenerationEvent = { run: string } & {
  [name in keyof Generations]: Generations[name][number];
};

export type ElitesEvent = ArchiveColumns & { run: string; generation: number };

export interface RewindEvent {
  run: string;
  generation: number;
}
