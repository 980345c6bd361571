/** The words of the wire, under the names that the page uses. */

import type { components, operations } from "./schema";

type Wire = components["schemas"];
/** A type of the server, with parts that OpenAPI can only call objects. */
type With<T, Parts> = Omit<T, keyof Parts> & Parts;

export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
export type Spec = { [key: string]: Json };
export type Schema = { [keyword: string]: Json };

export type Run = With<Wire["RunRead"], { spec: Spec; summary: Values | null }>;
/** How a run stands; what it is may be left out where that was told before. */
export type RunEvent = Omit<Run, "spec"> & { spec?: Spec };
export type RunPage = With<Wire["RunPage"], { items: Run[] }>;
/** What people may say of a run. */
export type RunChange = Partial<Pick<Run, "name" | "tags" | "note">>;
export type RunQuery = NonNullable<operations["list_runs_api_v1_runs_get"]["parameters"]["query"]>;
export type Sweep = With<Wire["SweepRead"], { spec: Spec; grid: Grid; cases: SweepCase[] }> & Owned;
/** With the name of the token it was made with, null without one. */
export type Owned = { owner: string | null };
export type SweepPage = With<Wire["SweepPage"], { items: Sweep[] }>;
export type SweepChanged = Sweep & Pick<Wire["SweepChanged"], "changed" | "skipped">;
export type SweepCase = { values: CaseValues; runs: string[] };
export type SweepSummary = With<Wire["SweepSummary"], { cases: CaseSummary[] }>;
export type CaseSummary = With<Wire["CaseSummary"], { values: CaseValues }>;
export type SweepCurves = Wire["SweepCurves"];
export type SweepEstimate = Wire["SweepEstimate"];
export type Member = Wire["SweepRun"];
export type Spread = Omit<Wire["Final"], "values">;
/** What a case has at the fields of the grid, by their paths. */
export type CaseValues = { [path: string]: Json };
export type Grid = { [path: string]: Json[] };
/** What is asked for: each case of the grid with each seed. */
export interface SweepRequest {
  spec: Spec;
  seeds: number | number[];
  grid: Grid;
  name: string | null;
}
/** A run that begins from another's creatures, its spec changed by a merge patch. */
export interface ForkRequest {
  run: string;
  from: { creatures: string[] } | { cells: number[] } | { archive: true };
  /** Elites as they were after it; left out: as they are. */
  generation?: number;
  spec: Spec;
  name: string | null;
}
export type Worker = Wire["WorkerRead"];
export type Queue = Wire["QueueRead"];
export type Preset = With<Wire["PresetRead"], { spec: Spec }>;
export type Experiment = With<Wire["ExperimentRead"], { schema: Schema; presets: Preset[] }>;
export type Estimate = Wire["EstimateRead"];
export type Drawing = Wire["DrawingRead"];
export type DrawnBody = Wire["BodyRead"];
export type DrawnPicture = Wire["PictureRead"];
export type Axis = Wire["Axis"];
export type Archive = Wire["ArchiveRead"];
export type History = Wire["HistoryRead"];
export type ArchiveColumns = Pick<
  Archive,
  "cell" | "fitness" | "descriptors" | "elite_generation" | "creature"
>;
export type Generations = Wire["Curves"];
export type LogEntry = Wire["LogEntryRead"];
export type SpeciesHistory = Wire["Species"];
export type Principal = Wire["PrincipalRead"];
export type Token = Wire["TokenRead"];
export type CreatedToken = Wire["TokenCreated"];
export type TokenCreate =
  operations["create_token_api_v1_tokens_post"]["requestBody"]["content"]["application/json"];
export type TokenScope = Token["scope"];
/** A picture that a filament folds into. */
export type Target = Wire["Target"];

export type Value = null | boolean | number | string;
export type Values = { [name: string]: Value };
/** A line of a run's result; `creature` names whom it is about, if anybody. */
export type ResultRow = Values & { creature: string | null };
export type Results = With<Wire["ResultsRead"], { rows: ResultRow[]; summary: Values | null }>;

/** A network of nodes and connections; one may grow the body too. */
export interface Genes {
  encoding: "cppn" | "cppn-body";
  control: Spec;
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

/** A gait made by hand, in the place of genes. */
export interface Gait {
  encoding: "gait";
  swimmer: string;
  period: number;
  ramp: number;
  /** The version of a plug-in. */
  plugin?: Spec;
}

/** Genes that are numbers: a controller itself, a network's weights, or a rest shape. */
export interface Vector {
  encoding: "direct" | "weights" | "fold";
  control: Spec;
  values: string;
  /** Of a network whose weights these are. */
  inputs?: string[];
  outputs?: string[];
}

export type Genome = Genes | Vector | Gait;

export type Relative = Wire["Relative"];
export type Ancestors = Wire["Ancestors"];
export type Children = Wire["Children"];
export type Measurement = Wire["Measurement"];
export type Share = Wire["ShareRead"];
export type ShareRequest =
  operations["publish_api_v1_shares_post"]["requestBody"]["content"]["application/json"];

export interface AuditRow {
  name: string;
  quantity: string;
  value: number | null;
  unit: string;
  /** What it needs to be, in words. */
  bar: string | number | null;
  passed: boolean | null;
  /** What it means where it has not passed. */
  note: string;
}

/** Whether a creature's swimming survives refinement, and the figures that say so. */
export interface Audit {
  verdict: { survives: boolean; reasons: string[] };
  rows: AuditRow[];
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
    measures: { [name: string]: number };
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
  /** Who is to be named. */
  credit?: string[];
}

/** What an error's body should be; something between page and server may answer otherwise. */
export type ProblemDocument = Partial<Wire["Problem"]>;
export type FieldError = Pick<Wire["FieldError"], "field" | "message">;

type GenerationColumns = Omit<Generations, "summary">;

/** The last entry of each column of `Generations`, and everything else that was told. */
export type GenerationEvent = { run: string; summary: Values | null } & {
  [name in keyof GenerationColumns]: GenerationColumns[name][number];
};

export type ElitesEvent = ArchiveColumns & { run: string; generation: number };

export interface ResultsEvent {
  run: string;
  generation: number;
  /** As the run's, where this generation changed it. */
  summary: Values | null;
  rows: ResultRow[];
}

export interface RewindEvent {
  run: string;
  generation: number;
}
