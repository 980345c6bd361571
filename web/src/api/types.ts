/** The words of the wire, under the names that the page uses. */

export type Status = "queued" | "running" | "paused" | "finished" | "failed" | "cancelled";

export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
export type Spec = { [key: string]: Json };

export interface Run {
  id: string;
  experiment: string;
  status: Status;
  wish: null | "pause" | "cancel";
  spec: Spec;
  created_at: string;
  started_at: string | null;
  finished_at: string | null;
  attempt: number;
  generation: number;
  generations: number;
  progress: number;
  eta_seconds: number | null;
  evaluations: number;
  evaluations_per_second: number | null;
  qd_score: number | null;
  coverage: number | null;
  best: number | null;
  diverged: number;
  sparkline: number[];
  error: string | null;
  warning: string | null;
  device: string | null;
  version: string;
  demonstration: boolean;
}

export interface RunPage {
  items: Run[];
  next: string | null;
}

export interface Schema {
  [keyword: string]: Json;
}

export interface Preset {
  name: string;
  title: string;
  spec: Spec;
}

export interface Experiment {
  experiment: string;
  title: string;
  schema: Schema;
  presets: Preset[];
}

export interface Estimate {
  memory_bytes: number;
  memory_limit_bytes: number;
  evaluations: number;
  cell_steps: number;
}

export interface Axis {
  name: string;
  low: number;
  high: number;
  bins: number;
  scale: "log10" | "linear";
}

export interface ArchiveColumns {
  cell: number[];
  fitness: number[];
  descriptors: number[][];
  elite_generation: number[];
  creature: string[];
}

export interface Archive extends ArchiveColumns {
  generation: number;
  axes: Axis[];
}

export interface Generations {
  generation: number[];
  qd_score: number[];
  coverage: number[];
  best: number[];
  mean: number[];
  evaluations: number[];
  diverged: number[];
  seconds: number[];
}

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
  };
  provenance: {
    parents: string[];
    operator: string;
    generation: number;
    seed: number;
    version: string;
  };
  licence: string;
}

export interface FieldError {
  field: string;
  message: string;
}

export interface ProblemDocument {
  title?: string;
  status?: number;
  detail?: string;
  errors?: FieldError[];
}

export interface GenerationEvent {
  run: string;
  generation: number;
  qd_score: number;
  coverage: number;
  best: number;
  mean: number;
  evaluations: number;
  diverged: number;
  seconds: number;
}

export interface ElitesEvent extends ArchiveColumns {
  run: string;
  generation: number;
}

export interface RewindEvent {
  run: string;
  generation: number;
}
