/** What a creature file says of its creature, as rows of words. */

import type { Creature, Genome, Spec } from "../api/types";
import { couplingFacts } from "../ui/coupling";
import { number, percent, words } from "../ui/format";

const UNKNOWN = "unknown";
const NOT_MEASURED = "not measured";

type Row = [name: string, value: string];

/** Measures whose bare name does not say what they are. */
const MEASURES: Record<string, [name: string, write: (value: number) => string]> = {
  displacement: ["Displacement", (value) => `${number(value, 6)} cells`],
  cycle: ["In the last cycle", (value) => `${number(value, 6)} cells`],
  direction: ["Direction", (value) => `${number(value)} rad`],
  bending_effort: ["Bending effort", (value) => `${number(value, 6)} rad²`],
  stretching_effort: ["Stretching effort", (value) => `${number(value, 6)} cells²`],
  path_length: ["Path length", (value) => `${number(value, 6)} cells`],
  rotation: ["Rotation", (value) => `${number(value)} rad`],
  turning: ["Turning", (value) => `${number(value)} rad`],
  energy: ["Energy collected", number],
  mean_speed: ["Mean speed", (value) => `${number(value)} cells/step`],
  curvature_mean: ["Mean curvature", (value) => `${number(value)} / cell`],
  curvature_spread: ["Spread of curvature", (value) => `${number(value)} / cell`],
  reynolds: ["Reynolds number", number],
  sperm: ["Sperm number", number],
  mach: ["Mach number", number],
  limited: ["Limits active", (value) => `${percent(value)} of node steps`],
  impulse: ["Net impulse", (value) => `${number(value)} lattice units`],
};

export function measurementsOf({ identity, measured }: Creature): Row[] {
  if (!measured) return [["Fitness", NOT_MEASURED]];
  const figures = Object.entries({ ...measured.descriptors, ...measured.measures });
  const gait = identity.genome.encoding === "gait";
  return [
    ...(gait ? [] : [["Fitness", number(measured.fitness, 6)] as Row]),
    ...figures.map(([name, value]): Row => {
      const own = ownOf({ identity, measured })[name];
      const [title, write] = MEASURES[name] ?? [own?.title ?? words(name), (x: number) => number(x, 6)];
      return [title, own?.unit ? `${write(value)} ${own.unit}` : write(value)];
    }),
  ];
}

/** What a creature was measured with of users' own, by name. */
function ownOf({ identity, measured }: Pick<Creature, "identity" | "measured">): Record<string, Own> {
  const task = identity.task as { fitness?: string; own?: Own } | undefined;
  const measures = (measured as { own?: Record<string, Own> } | null)?.own ?? {};
  return task?.own ? { ...measures, [task.fitness!]: task.own } : measures;
}

interface Own {
  title: string;
  unit: string;
  source: string;
}

/** Names, titles and versions of what a creature needs of users' own. */
function needsOf(creature: Creature): Row[] {
  const { genome } = creature.identity;
  const control = "control" in genome ? genome.control : (genome as unknown as Spec);
  const moved = control.own as unknown as Own | undefined;
  const name = "swimmer" in genome ? genome.swimmer : genome.encoding;
  const all = { ...ownOf(creature), ...(moved && { [name]: moved }) };
  const told = Object.entries(all).map(
    ([own, { title, source }]) => `${title} (${own}, version ${source.slice(0, 12)})`,
  );
  return told.length > 0 ? [["Of one's own", told.join("; ")]] : [];
}

interface Group {
  title: string;
  rows: Row[];
}

/** Under which heading a measure stands; others are about the swimming as a whole. */
const GROUPS: [title: string, names: string[]][] = [
  ["Control", ["bending_effort", "stretching_effort", "power", "efficiency"]],
  ["Shape", ["curvature_mean", "curvature_spread", "symmetry", "rotation", "turning", "nodes"]],
  ["Network", ["hidden_nodes", "connections"]],
  ["Flow", ["reynolds", "sperm", "mach", "limited", "impulse"]],
];

/** Measurements in groups of what they are about. */
export function groupsOf(creature: Creature): Group[] {
  const { measured, identity } = creature;
  if (!measured) return [{ title: "Result", rows: measurementsOf(creature) }];
  const figures = { ...measured.descriptors, ...measured.measures };
  const among = (names: string[], inside: boolean) => {
    const some = Object.entries(figures).filter(([name]) => names.includes(name) === inside);
    return { ...measured, descriptors: {}, measures: Object.fromEntries(some) };
  };
  const named = GROUPS.flatMap(([, names]) => names);
  const first = { title: "Result", rows: measurementsOf({ ...creature, measured: among(named, false) }) };
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
    ["Body", bodyOf(identity.body)],
    ["World", worldOf(identity.world)],
    ...(identity.genome.encoding === "gait"
      ? []
      : [["Generation", String(provenance?.generation ?? UNKNOWN)] as Row]),
    ["Made by", provenance?.operator ?? UNKNOWN],
    ["Seed", String(provenance?.seed ?? UNKNOWN)],
    ["Device", measured?.device ?? UNKNOWN],
    ["Licence", licence],
    ...(credit?.length ? [["Credit", credit.join(", ")] as Row] : []),
  ];
}

/** How body and fluid act on each other; nothing where there is no fluid. */
export const formOf = ({ identity }: Creature): Row[] =>
  identity.world.fluid === false ? [] : couplingFacts(identity.world.coupling);

function gaitOf(genome: Genome): Row[] {
  if (genome.encoding !== "gait") return [];
  return [
    ["Swimmer", words(genome.swimmer)],
    ["Period", `${number(genome.period)} steps`],
    ["Ramp", `${number(genome.ramp)} ${genome.ramp === 1 ? "period" : "periods"}`],
  ];
}

const ENCODINGS: Record<string, string> = {
  cppn: "a network that controls",
  "cppn-body": "a network that grows the body and controls it",
  direct: "the control of every joint and edge",
  weights: "the weights of a given network",
};

function encodingOf({ encoding, ...genome }: Genome): Row[] {
  const known = ENCODINGS[encoding];
  const recurrent = "control" in genome && genome.control.recurrent === true;
  return known ? [["Genome", recurrent ? `${known}, with memory` : known]] : [];
}

function bodyOf({ builder, nodes }: Spec): string {
  const count = Array.isArray(nodes) ? nodes.length : nodes;
  const name = words(String(builder ?? "chain"));
  return typeof count === "number" ? `${name}, ${count} nodes` : name;
}

function worldOf({ width, height, viscosity, steric, energy, fluid }: Spec): string {
  const fields = [steric && "steric repulsion", energy && "energy"].filter(Boolean);
  const water = fluid === false ? "no fluid" : `ν = ${number(viscosity as number)}`;
  const size = `${width} × ${height} cells, ${water}`;
  return [size, ...fields].join(", ");
}
