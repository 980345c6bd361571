/** Ancestors and children of a creature, as a tree: parents at the left, children at the right, bars for fitness. */

import { useMemo } from "preact/hooks";
import * as api from "../api/client";
import { sharedSlug, pageUrl } from "../api/address";
import type { Ancestors, Children, Creature, Relative } from "../api/types";
import { useFetched } from "../store/fetch";
import { setQuery } from "../store/router";
import { Card } from "../ui/Page";
import { count, number, shortId } from "../ui/format";
import { text } from "./text";
import { px } from "../ui/canvas";

/** Generations of ancestors: shown at first, added by each click, and at most. */
const [FIRST_DEPTH, DEPTH_STEP, MAX_DEPTH] = [2, 2, 12];

export function FamilyCard({ creature, query }: { creature: Creature; query: URLSearchParams }) {
  const sha = creature.sha256;
  const back = Math.min(MAX_DEPTH, Math.max(1, Math.round(Number(query.get("back")) || FIRST_DEPTH)));
  const { value, error } = useFetched(() => api.readFamily(sha, back), [sha, back]);
  const tree = useMemo(() => value && familyLayoutOf(selfOf(creature), ...value), [creature, value]);
  const run = query.get("run");
  // A share of one creature lists its ancestors without links.
  const hrefOf = (name: string) =>
    sharedSlug && !run ? null : pageUrl(`/creatures/${name}${run ? `?run=${run}` : ""}`);
  const credited = value ? creditOf(value[0].items, creature) : [];
  const unstored = value?.[0].items.some(({ stored }) => !stored);
  const more = value?.[0].more && back < MAX_DEPTH && (
    <button onClick={() => setQuery({ back: String(back + DEPTH_STEP) })}>{text.moreAncestors}</button>
  );
  const actions = (
    <>
      {more}
      <TreeLink sha={sha} run={run} />
    </>
  );
  return (
    <Card id="family" title={sharedSlug ? text.ancestors : text.family} actions={actions}>
      {error && (
        <p class="banner wrong">
          {error} {text.reload}
        </p>
      )}
      {!value && !error && <p class="quiet loading">{text.loadingFamily}</p>}
      {tree && tree.relatives.length === 1 && (
        <p class="quiet">{creature.provenance ? text.noParents(!sharedSlug) : text.noOrigin}</p>
      )}
      {tree && tree.relatives.length > 1 && <FamilyTree {...{ tree, hrefOf }} self={sha} />}
      {credited.length > 0 && <p class="quiet small">{text.creditAncestors(credited.join(", "))}</p>}
      {tree && (unstored || tree.hidden > 0) && (
        <p class="quiet small">
          {unstored && text.dashed}
          {tree.hidden > 0 && text.hiddenChildren(count(tree.hidden))}
        </p>
      )}
    </Card>
  );
}

/** The tree of the run that led here, with this creature; else that of the creature across runs, or in the share. */
function treePage(sha: string, run: string | null): string {
  if (sharedSlug) return `${location.pathname.replace(/\/$/, "")}/tree`;
  return run ? `/runs/${run}/tree?creature=${sha}` : `/creatures/${sha}/tree`;
}

const TreeLink = ({ sha, run }: { sha: string; run: string | null }) => (
  <a class="button" href={treePage(sha, run)} title={text.treeAbout}>
    {text.tree}
  </a>
);

/** Credits of the ancestors with their licences, without those of the creature itself. */
function creditOf(ancestors: Relative[], { credit }: Creature): string[] {
  const named = ancestors.flatMap(({ credit, licence }) =>
    (credit ?? []).map((name) => [name, `${name} (${licence})`] as const),
  );
  const others = named.filter(([name]) => !credit?.includes(name));
  return [...new Set(others.map(([, label]) => label))];
}

function selfOf({ sha256, measured, provenance }: Creature): Relative {
  return {
    creature: sha256,
    distance: 0,
    stored: true,
    parents: provenance?.parents ?? [],
    operator: provenance?.operator ?? null,
    generation: provenance?.generation ?? null,
    fitness: measured?.fitness ?? null,
    licence: null,
    credit: [],
  };
}

interface FamilyTreeProps {
  tree: FamilyLayout;
  self: string;
  /** Null if the creature has no page here. */
  hrefOf: (creature: string) => string | null;
}

/** Size of a name, in pixels: parents, creature and children fit on a phone. */
const [COLUMN_WIDTH, ROW_HEIGHT] = [92, 34];
const TITLE_HEIGHT = 36;
const NAME_HEIGHT = ROW_HEIGHT - 8;

function FamilyTree({ tree, self, hrefOf }: FamilyTreeProps) {
  const known = tree.relatives.map(({ relative }) => relative.fitness ?? 0);
  const most = Math.max(1e-12, ...known.map(Math.abs));
  return (
    <div
      class="scroll"
      tabIndex={0}
      role="group"
      aria-label={text.familyTree}
      ref={(box) => void box?.scrollTo(box.scrollWidth, 0)}
    >
      <div class="family" style={px({ width: tree.width, height: tree.height + TITLE_HEIGHT })}>
        <svg width={tree.width} height={tree.height + TITLE_HEIGHT} aria-hidden="true">
          {tree.lines.map(([parent, child]) => (
            <path key={`${parent.relative.creature}${child.relative.creature}`} d={pathOf(parent, child)} />
          ))}
        </svg>
        {tree.columns.map(({ x, title }) => (
          <span key={title} class="family-title" style={px({ left: x, width: COLUMN_WIDTH })}>
            {title}
          </span>
        ))}
        <ul>
          {tree.relatives.map(({ relative, x, y }) => (
            <li
              key={relative.creature}
              style={px({
                left: x,
                top: TITLE_HEIGHT + y - NAME_HEIGHT / 2,
                width: COLUMN_WIDTH,
                height: NAME_HEIGHT,
              })}
            >
              <Name
                {...{ relative, most }}
                isSelf={relative.creature === self}
                href={hrefOf(relative.creature)}
              />
            </li>
          ))}
        </ul>
      </div>
    </div>
  );
}

function pathOf(parent: PlacedRelative, child: PlacedRelative): string {
  const [x, end] = [parent.x + COLUMN_WIDTH, child.x];
  const middle = (x + end) / 2;
  const [from, to] = [TITLE_HEIGHT + parent.y, TITLE_HEIGHT + child.y];
  return `M${x},${from}C${middle},${from} ${middle},${to} ${end},${to}`;
}

interface NameProps {
  relative: Relative;
  most: number;
  isSelf: boolean;
  href: string | null;
}

function Name({ relative, most, isSelf, href }: NameProps) {
  const { creature, stored, fitness } = relative;
  const title = aboutOf(relative);
  const common = {
    class: `family-name ${isSelf ? "self" : stored ? "" : "unstored"}`,
    title,
    children: (
      <>
        <code>{shortId(creature)}</code>
        {fitness !== null && (
          <span class="family-fitness" style={{ width: `${(100 * Math.abs(fitness)) / most}%` }} />
        )}
      </>
    ),
  };
  if (isSelf || !stored || href === null) return <span {...common} />;
  return <a href={href} aria-label={title} {...common} />;
}

/** Describe a relative. */
function aboutOf({ creature, stored, fitness, operator, generation }: Relative): string {
  if (!stored) return text.neverElite(shortId(creature));
  const parts = [
    fitness === null ? null : text.fitnessOf(number(fitness)),
    generation === null ? null : text.generationOf(generation),
    operator && text.madeBy(operator),
  ];
  return [shortId(creature), ...parts.filter(Boolean)].join(", ");
}

interface PlacedRelative {
  relative: Relative;
  x: number;
  y: number;
}

type FamilyLayout = ReturnType<typeof familyLayoutOf>;
type Line = [parent: PlacedRelative, child: PlacedRelative];

const GAP = 20;
/** Relatives drawn per generation. */
const MAX_PER_COLUMN = 8;

/** Children are sorted by fitness, ancestors by distance. */
export function familyLayoutOf(self: Relative, ancestors: Ancestors, children: Children) {
  const deepest = Math.max(0, ...ancestors.items.map(({ distance }) => distance));
  const levels = Array.from({ length: deepest }, (_, i) =>
    ancestors.items.filter(({ distance }) => distance === deepest - i),
  );
  const below = children.items.length > 0 ? [children.items] : [];
  const columns = [...levels, [self], ...below].map((level) => level.slice(0, MAX_PER_COLUMN));
  const height = ROW_HEIGHT * Math.max(...columns.map((column) => column.length));
  const relatives = columns.flatMap((column, i) =>
    column.map((relative, k) => ({
      relative,
      x: i * (COLUMN_WIDTH + GAP),
      y: (height * (k + 0.5)) / column.length,
    })),
  );
  return {
    width: columns.length * (COLUMN_WIDTH + GAP) - GAP,
    height,
    relatives,
    lines: linesOf(relatives, self, ancestors),
    columns: columns.map((_, i) => ({ x: i * (COLUMN_WIDTH + GAP), title: titleOf(deepest - i) })),
    hidden: children.total - Math.min(MAX_PER_COLUMN, children.items.length),
  };
}

function linesOf(relatives: PlacedRelative[], self: Relative, { parents }: Ancestors): Line[] {
  const byName = new Map(relatives.map((one) => [one.relative.creature, one]));
  const me = byName.get(self.creature)!;
  return relatives.flatMap((child): Line[] => {
    // Other parents of a child are not shown.
    if (child.x > me.x) return [[me, child]];
    const names = child === me ? parents : child.relative.parents;
    return [...new Set(names)]
      .flatMap((name) => byName.get(name) ?? [])
      .filter((parent) => parent.x < child.x)
      .map((parent) => [parent, child]);
  });
}

const TITLES = [text.thisCreature, text.parents, text.grandparents];

function titleOf(distance: number): string {
  if (distance < 0) return text.children;
  return TITLES[distance] ?? text.generationsBack(distance);
}
