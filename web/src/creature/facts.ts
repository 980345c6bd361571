/** The contents of a creature file as rows of a table. */

import type { Creature, Genome, Spec } from "../api/types";
import { couplingFacts } from "../ui/coupling";
import { number, percent, words } from "../ui/format";
import { text } from "./text";

const UNKNOWN = text.unknown;
const NOT_MEASURED = text.notMeasured;

type Row = [name: string, value: string];

/** Titles and units of measures. */
const MEASURES: Record<string, [name: string, write: (value: number) => string]> = {
  displacement: [text.displacement, (value) => `${number(value, 6)} cells`],
  cycle: [text.lastCycle, (value) => `${number(value, 6)} cells`],
  direction: [text.direction, (value) => `${number(value)} rad`],
  bending_effort: [text.bendingEffort, (value) => `${number(value, 6)} rad²`],
  stretching_effort: [text.stretchingEffort, (value) => `${number(value, 6)} cells²`],
  path_length: [text.pathLength, (value) => `${number(value, 6)} cells`],
  rotation: [text.rotation, (value) => `${number(value)} rad`],
  turning: [text.turning, (value) => `${number(value)} rad`],
  energy: [text.energyCollected, number],
  mean_speed: [text.meanSpeed, (value) => `${number(value)} cells/step`],
  curvature_mean: [text.meanCurvature, (value) => `${number(value)} / cell`],
  curvature_spread: [text.curvatureSpread, (value) => `${number(value)} / cell`],
  reynolds: [text.reynolds, number],
  sperm: [text.sperm, number],
  mach: [text.mach, number],
  limited: [text.limited, (value) => `${percent(value)} of node steps`],
  impulse: [text.impulse, (value) => `${number(value)} lattice units`],
};

export function measurementsOf({ identity, measured }: Creature): Row[] {
  if (!measured) return [[text.fitness, NOT_MEASURED]];
  const figures = Object.entries({ ...measured.descriptors, ...measured.measures });
  const gait = identity.genome.encoding === "gait";
  return [
    ...(gait ? [] : [[text.fitness, number(measured.fitness, 6)] as Row]),
    ...figures.map(([name, value]): Row => {
      const plugin = pluginsOf({ identity, measured })[name];
      const [title, write] = MEASURES[name] ?? [plugin?.title ?? words(name), (x: number) => number(x, 6)];
      return [title, plugin?.unit ? `${write(value)} ${plugin.unit}` : write(value)];
    }),
  ];
}

/** Plug-ins that measured a creature, by name. */
function pluginsOf({ identity, measured }: Pick<Creature, "identity" | "measured">): Record<string, Plugin> {
  const task = identity.task as { fitness?: string; plugin?: Plugin } | undefined;
  const measures = (measured as { plugins?: Record<string, Plugin> } | null)?.plugins ?? {};
  return task?.plugin ? { ...measures, [task.fitness!]: task.plugin } : measures;
}

interface Plugin {
  title: string;
  unit: string;
  source: string;
}

/** Titles, names and versions of the plug-ins that a creature needs. */
function needsOf(creature: Creature): Row[] {
  const { genome } = creature.identity;
  const control = "control" in genome ? genome.control : (genome as unknown as Spec);
  const actuating = control.plugin as unknown as Plugin | undefined;
  const controller = "swimmer" in genome ? genome.swimmer : genome.encoding;
  const all = { ...pluginsOf(creature), ...(actuating && { [controller]: actuating }) };
  const told = Object.entries(all).map(([name, { title, source }]) =>
    text.pluginVersion(title, name, source.slice(0, 12)),
  );
  return told.length > 0 ? [[text.plugins, told.join("; ")]] : [];
}

interface Group {
  title: string;
  rows: Row[];
}

/** Groups of measures; the others are in the group “Result”. */
const GROUPS: [title: string, names: string[]][] = [
  [text.control, ["bending_effort", "stretching_effort", "power", "efficiency"]],
  [text.shapeGroup, ["curvature_mean", "curvature_spread", "symmetry", "rotation", "turning", "nodes"]],
  [text.network, ["hidden_nodes", "connections"]],
  [text.flow, ["reynolds", "sperm", "mach", "limited", "impulse"]],
];

/** Measures in groups. */
export function groupsOf(creature: Creature): Group[] {
  const { measured, identity } = creature;
  if (!measured) return [{ title: text.resultGroup, rows: measurementsOf(creature) }];
  const figures = { ...measured.descriptors, ...measured.measures };
  const among = (names: string[], inside: boolean) => {
    const some = Object.entries(figures).filter(([name]) => names.includes(name) === inside);
    return { ...measured, descriptors: {}, measures: Object.fromEntries(some) };
  };
  const named = GROUPS.flatMap(([, names]) => names);
  const first = {
    title: text.resultGroup,
    rows: measurementsOf({ ...creature, measured: among(named, false) }),
  };
  const gait = { ...creature, identity: { ...identity, genome: { encoding: "gait" } as Genome } };
  // Like a gait's, the figures of a group have no fitness before them.
  const others = GROUPS.map(([title, names]) => ({
    title,
    rows: measurementsOf({ ...gait, measured: among(names, true) }),
  }));
  return [first, ...others.filter(({ rows }) => rows.length > 0)];
}

export function originOf({ identity, measured, provenance, licence, credit }: Creature): Row[] {
  return [
    ...gaitOf(identity.genome),
    ...encodingOf(identity.genome),
    ...needsOf({ identity, measured, provenance, licence } as Creature),
    [text.body, bodyOf(identity.body)],
    [text.world, worldOf(identity.world)],
    ...(identity.genome.encoding === "gait"
      ? []
      : [[text.generation, String(provenance?.generation ?? UNKNOWN)] as Row]),
    [text.operator, provenance?.operator ?? UNKNOWN],
    [text.seed, String(provenance?.seed ?? UNKNOWN)],
    [text.device, measured?.device ?? UNKNOWN],
    [text.licence, licence],
    ...(credit?.length ? [[text.credit, credit.join(", ")] as Row] : []),
  ];
}

/** The coupling of body and fluid; empty without a fluid. */
export const formOf = ({ identity }: Creature): Row[] =>
  identity.world.fluid === false ? [] : couplingFacts(identity.world.coupling);

function gaitOf(genome: Genome): Row[] {
  if (genome.encoding !== "gait") return [];
  return [
    [text.swimmer, words(genome.swimmer)],
    [text.period, `${number(genome.period)} steps`],
    [text.ramp, `${number(genome.ramp)} ${genome.ramp === 1 ? "period" : "periods"}`],
  ];
}

const ENCODINGS: Record<string, string> = {
  cppn: text.cppn,
  "cppn-body": text.cppnBody,
  direct: text.direct,
  weights: text.weights,
};

function encodingOf({ encoding, ...genome }: Genome): Row[] {
  const known = ENCODINGS[encoding];
  const recurrent = "control" in genome && genome.control.recurrent === true;
  return known ? [[text.genome, recurrent ? text.withMemory(known) : known]] : [];
}

function bodyOf({ builder, nodes }: Spec): string {
  const count = Array.isArray(nodes) ? nodes.length : nodes;
  const name = words(String(builder ?? "chain"));
  return typeof count === "number" ? text.bodyOf(name, count) : name;
}

function worldOf({ width, height, viscosity, steric, energy, fluid }: Spec): string {
  const fields = [steric && text.steric, energy && text.energy].filter(Boolean);
  const water = fluid === false ? text.noFluid : `ν = ${number(viscosity as number)}`;
  const size = text.worldOf(width, height, water);
  return [size, ...fields].join(", ");
}
