/** The contents of a creature file as rows of a table. */

import type { Creature, Genome, Spec } from "../api/types";
import { couplingFacts } from "../ui/coupling";
import { number, words } from "../ui/format";
import { GROUPS, type Titled, groupOf, titleOf, valueOf } from "../ui/measures";
import { text } from "./text";

type Row = [name: string, value: string];

export interface Group {
  title: string;
  rows: Row[];
}

/** The declaration of a plug-in in a creature file. */
interface Plugin extends Titled {
  source: string;
}

/** Groups of rows; `sperm` is the sperm number, which is no measure: it follows from the genes. */
export function groupsOf(creature: Creature, sperm: number | null = null): Group[] {
  const { measured, identity } = creature;
  const [[result, title]] = GROUPS as [[string, string]];
  if (!measured) return [{ title, rows: [[text.fitness, text.notMeasured]] }];
  const plugins = measuringPlugins(creature);
  const numbers = sperm === null ? {} : { sperm };
  const measures = Object.entries({ ...measured.descriptors, ...measured.measures, ...numbers });
  const fitness: Row = [text.fitness, number(measured.fitness, 6)];
  const groups = GROUPS.map(([key, title]): Group => {
    const inside = measures.filter(([name]) => groupOf(name) === key);
    const rows = inside.map(([name, value]): Row => {
      return [titleOf(name, plugins[name]), valueOf(name, value, plugins[name])];
    });
    return { title, rows: key === result && identity.genome.encoding !== "gait" ? [fitness, ...rows] : rows };
  });
  return groups.filter(({ rows }, i) => i === 0 || rows.length > 0);
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
