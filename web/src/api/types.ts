/** Types of requests, answers and events, under the names that the page uses. */

import type { components, operations } from "./schema";

type Wire = components["schemas"];
/** A type of the server with some fields more precise than in OpenAPI. */
type With<T, Parts> = Omit<T, keyof Parts> & Parts;

export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
export type Spec = { [key: string]: Json };
export type Schema = { [keyword: string]: Json };

export type Run = With<Wire["RunRead"], { spec: Spec; summary: Values | null }>;
/** The state of a run; the spec may be missing if it was sent before. */
export type RunEvent = Omit<Run, "spec"> & { spec?: Spec };
export type Tank = Wire["Tank"];
export type RunPage = With<Wire["RunPage"], { items: Run[] }>;
export type RunChange = Partial<
  Pick<Run, "name" | "tags" | "note" | "priority" | "labels" | "may_yield" | "device_patience">
>;
export type RunQuery = NonNullable<operations["list_runs_api_v1_runs_get"]["parameters"]["query"]>;
export type Sweep = With<Wire["SweepBrief"], { spec: Spec; grid: Grid }> & Owned;
/** `owner` is the name of the token; null without one. */
export type Owned = { owner: string | null };
export type SweepPage = With<Wire["SweepPage"], { items: Sweep[] }>;
export type SweepChanged = Sweep & Pick<Wire["SweepChanged"], "changed" | "skipped">;
export type SweepSummary = With<Wire["SweepSummary"], { cases: CaseSummary[] }>;
export type CaseSummary = With<Wire["CaseSummary"], { values: CaseValues }>;
export type SweepCurves = Wire["SweepCurves"];
export type Statistics = Wire["Statistics"];
/** The runs of a sweep, or runs by their ids, separated by commas. */
export type ComparedRuns = { sweep: string } | { runs: string };
export type MeasureStatistics = Wire["MeasureStatistics"];
export type SweepEstimate = Wire["SweepEstimate"];
export type Member = Wire["SweepRun"];
export type Spread = Omit<Wire["Final"], "values">;
/** Values of a case at the fields of the grid, by path. */
export type CaseValues = { [path: string]: Json };
type Grid = { [path: string]: Json[] };
/** Each case of the grid is run with each seed. */
export interface SweepRequest {
  spec: Spec;
  seeds: number | number[];
  grid: Grid;
  name: string | null;
}
/** A run from the creatures of another run; the spec is a merge patch. */
export interface ForkRequest {
  run: string;
  from: { creatures: string[] } | { cells: number[] } | { archive: true };
  /** The generation of the elites; by default the newest. */
  generation?: number;
  spec: Spec;
  name: string | null;
}
/** The chosen creatures of a run, to breed from. */
export type Choices = Wire["ChoicesRead"];
export type Worker = Wire["WorkerRead"];
export type Queue = Wire["QueueRead"];
export type Preset = With<Wire["PresetRead"], { spec: Spec }>;
export type Experiment = With<Wire["ExperimentRead"], { schema: Schema; presets: Preset[] }>;
export type Estimate = Wire["EstimateRead"];
export type Drawing = Wire["DrawingRead"];
export type DrawnBody = Wire["BodyRead"];
export type Axis = Wire["Axis"];
export type Archive = Wire["ArchiveRead"];
export type History = Wire["HistoryRead"];
export type Reprojection = Wire["ReprojectionRead"];
export type ArchiveColumns = Pick<
  Archive,
  "cell" | "fitness" | "descriptors" | "elite_generation" | "creature"
> &
  // Events have no verdicts: new elites are not audited.
  Partial<Pick<Archive, "trusted">>;
export type Generations = Wire["Curves"];
export type LogEntry = Wire["LogEntryRead"];
export type SpeciesHistory = Wire["Species"];
export type Principal = Wire["PrincipalRead"];
export type Token = Wire["TokenRead"];
export type CreatedToken = Wire["TokenCreated"];
export type TokenCreate =
  operations["create_token_api_v1_tokens_post"]["requestBody"]["content"]["application/json"];
export type TokenScope = Token["scope"];
/** A picture into which a filament folds. */
export type Target = Wire["Target"];

export type Value = null | boolean | number | string;
export type Values = { [name: string]: Value };
export type ResultRow = Values & { creature: string | null };
export type Results = With<Wire["ResultsRead"], { rows: ResultRow[]; summary: Values | null }>;

/** A network of nodes and connections; `body-graph` has a plan for the body. */
export interface Genes {
  encoding: "cppn" | "body-graph";
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
  /** Columns of the genes of segments. */
  plan?: Record<string, unknown>;
}

/** A gait designed by hand, in place of genes. */
export interface Gait {
  encoding: "gait";
  swimmer: string;
  period: number;
  ramp: number;
  /** The version of a plug-in. */
  plugin?: Spec;
}

/** Numeric genes: a control signal, or a rest shape. */
export interface Vector {
  encoding: "direct" | "fold";
  control: Spec;
  values: string;
}

export type Genome = Genes | Vector | Gait;

export type NetworkPositions = Wire["NetworkPositions"];
export type PlanDrawing = Wire["PlanDrawing"];
export type Stroke = Wire["Stroke"];
export type Units = Wire["Units"];
export type UnitsQuery = NonNullable<operations["read_units_api_v1_units_get"]["parameters"]["query"]>;
export type PlanSegment = Wire["PlanSegment"];
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
  /** The limit, as a number or in words. */
  bar: string | number | null;
  passed: boolean | null;
  /** The meaning of a failure. */
  note: string;
}

/** The verdict on a creature's swimming, with its figures. */
export interface Audit {
  verdict: { trusted: boolean; reasons: string[] };
  rows: AuditRow[];
}

/** A creature file; an imported one may lack measures and origin. */
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
  credit?: string[];
}

/** The body of an error; a proxy may answer with anything else. */
export type ProblemDocument = Partial<Wire["Problem"]>;
type Error = Wire["FieldError"];
/** An error of a field; `least` or `most` is the nearest number that it accepts. */
export type FieldError = Pick<Error, "field" | "reason"> & Partial<Pick<Error, "least" | "most">>;

type GenerationColumns = Omit<Generations, "summary">;

/** The last entry of each column of `Generations`, and the summary of the generation. */
export type GenerationEvent = { run: string; summary: Values | null } & {
  [name in keyof GenerationColumns]: GenerationColumns[name][number];
};

export type ElitesEvent = ArchiveColumns & {
  run: string;
  generation: number;
  /** Cells that lost their elite and have no new one. */
  emptied: number[];
};

export interface ResultsEvent {
  run: string;
  generation: number;
  /** The summary of the run, if this generation changed it. */
  summary: Values | null;
  rows: ResultRow[];
}

export interface RewindEvent {
  run: string;
  generation: number;
}
