/** The contents of a creature file as rows of a table. */

import type { Creature, Genome, Spec } from "../api/types";
import { couplingFacts } from "../ui/coupling";
import { number, words } from "../ui/format";
import { text } from "./text";

type Row = [name: string, value: string];

export interface Group {
  title: string;
  rows: Row[];
}

/** The declaration of a plug-in in a creature file. */
interface Plugin {
  title: string;
  unit: string;
  source: string;
}

const FORM = ["segments", "free_ends", "rings", "total_length", "form_symmetry", "form_aspect", "ungrown"];

/** Groups of measures; all others belong to the result. */
const GROUPS: [title: string, names: string[]][] = [
  [text.control, ["bending_effort", "stretching_effort", "power", "efficiency"]],
  [
    text.shapeGroup,
    ["curvature_mean", "curvature_spread", "symmetry", "rotation", "turning", "nodes", "crossing"],
  ],
  [text.formGroup, FORM],
  [text.network, ["hidden_nodes", "connections"]],
  [text.flow, ["reynolds", "strouhal", "sperm", "mach", "limited", "impulse"]],
];

/** Groups of rows; `sperm` is the sperm number, which is no measure: it follows from the genes. */
export function groupsOf(creature: Creature, sperm: number | null = null): Group[] {
  const { measured, identity } = creature;
  if (!measured) return [{ title: text.resultGroup, rows: [[text.fitness, text.notMeasured]] }];
  const plugins = measuringPlugins(creature);
  const numbers = sperm === null ? {} : { sperm };
  const measures = Object.entries({ ...measured.descriptors, ...measured.measures, ...numbers });
  const rowsOf = (belongs: (name: string) => boolean) =>
    measures.filter(([name]) => belongs(name)).map(([name, value]) => measureRow(name, value, plugins[name]));
  const grouped = GROUPS.flatMap(([, names]) => names);
  const fitness: Row = [text.fitness, number(measured.fitness, 6)];
  const result = [
    ...(identity.genome.encoding === "gait" ? [] : [fitness]),
    ...rowsOf((name) => !grouped.includes(name)),
  ];
  const others = GROUPS.map(([title, names]) => ({ title, rows: rowsOf((name) => names.includes(name)) }));
  return [{ title: text.resultGroup, rows: result }, ...others.filter(({ rows }) => rows.length > 0)];
}

function measureRow(name: string, value: number, plugin: Plugin | undefined): Row {
  const [title, unit, digits] = text.measures[name] ?? [plugin?.title ?? words(name), plugin?.unit ?? "", 6];
  const shown = number(unit.startsWith("%") ? 100 * value : value, digits);
  return [title, unit ? `${shown} ${unit}` : shown];
}

/** Plug-ins that measured a creature, by name. */
function measuringPlugins({ identity, measured }: Creature): Record<string, Plugin> {
  const task = identity.task as { fitness?: string; plugin?: Plugin } | undefined;
  const measures = (measured as { plugins?: Record<string, Plugin> } | null)?.plugins ?? {};
  return task?.plugin ? { ...measures, [task.fitness!]: task.plugin } : measures;
}

/** Titles, names and versions of the plug-ins that a creature needs. */
function pluginRows(creature: Creature): Row[] {
  const { genome } = creature.identity;
  const control = "control" in genome ? genome.control : (genome as unknown as Spec);
  const controller = control.plugin as unknown as Plugin | undefined;
  const name = "swimmer" in genome ? genome.swimmer : genome.encoding;
  const all = { ...measuringPlugins(creature), ...(controller && { [name]: controller }) };
  const versions = Object.entries(all).map(([plugin, { title, source }]) =>
    text.pluginVersion(title, plugin, source.slice(0, 12)),
  );
  return versions.length > 0 ? [[text.plugins, versions.join("; ")]] : [];
}

export function originOf(creature: Creature): Row[] {
  const { identity, measured, provenance, licence, credit, sha256 } = creature;
  const known = (value: string | number | undefined) => String(value ?? text.unknown);
  const generation: Row = [text.generation, known(provenance?.generation)];
  return [
    ...genomeRows(identity.genome),
    ...pluginRows(creature),
    [text.body, bodyOf(identity.body)],
    [text.world, worldOf(identity.world)],
    ...(identity.genome.encoding === "gait" ? [] : [generation]),
    [text.operator, known(provenance?.operator)],
    [text.seed, known(provenance?.seed)],
    [text.device, known(measured?.device)],
    [text.licence, licence],
    ...(credit?.length ? [[text.credit, credit.join(", ")] as Row] : []),
    [text.sha, sha256],
  ];
}

/** The coupling of body and fluid; empty without a fluid. */
export const couplingRows = ({ identity }: Creature): Row[] =>
  identity.world.fluid === false ? [] : couplingFacts(identity.world.coupling);

function genomeRows(genome: Genome): Row[] {
  if (genome.encoding === "gait") {
    return [
      [text.swimmer, words(genome.swimmer)],
      [text.period, `${number(genome.period)} steps`],
      [text.ramp, `${number(genome.ramp)} ${genome.ramp === 1 ? "period" : "periods"}`],
    ];
  }
  const known = text.encodings[genome.encoding];
  if (!known) return [];
  return [[text.genome, genome.control.recurrent === true ? text.withMemory(known) : known]];
}

function bodyOf({ builder, nodes }: Spec): string {
  const count = Array.isArray(nodes) ? nodes.length : nodes;
  const name = words(String(builder ?? "chain"));
  if (typeof count !== "number") return name;
  return builder === "grown" ? text.grownBody(name, count) : text.bodyOf(name, count);
}

function worldOf({ width, height, viscosity, steric, energy, fluid }: Spec): string {
  const fields = [steric && text.steric, energy && text.energy].filter(Boolean);
  const water = fluid === false ? text.noFluid : `ν = ${number(viscosity as number)}`;
  return [text.worldOf(width, height, water), ...fields].join(", ");
}
