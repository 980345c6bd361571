/** Ancestors and children of a creature. */

import { useMemo } from "preact/hooks";
import * as api from "../api/client";
import { sharedSlug, pageUrl } from "../api/address";
import type { Creature, Relative } from "../api/types";
import { useFetched } from "../store/fetch";
import { setQuery } from "../store/router";
import { FamilyTree } from "./FamilyTree";
import { familyLayoutOf } from "./familyLayout";
import { Card } from "../ui/Page";
import { count } from "../ui/format";
import { text } from "./text";

/** Generations of ancestors: shown at first, added by each click, and at most. */
const [FIRST_DEPTH, DEPTH_STEP, MAX_DEPTH] = [2, 2, 12];

interface Props {
  creature: Creature;
  query: URLSearchParams;
}

export function FamilyCard({ creature, query }: Props) {
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
