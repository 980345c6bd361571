/** Where a creature comes from, and what came of it. */

import { useMemo } from "preact/hooks";
import * as api from "../api/client";
import { sharedSlug, pageUrl } from "../api/address";
import type { Creature, Relative } from "../api/types";
import { useFetched } from "../store/fetch";
import { setQuery } from "../store/router";
import { FamilyTree } from "./FamilyTree";
import { familyLayoutOf } from "./relatives";
import { count } from "../ui/format";

/** Generations that are looked back at first, further, and at most. */
const [NEAR, FURTHER, FARTHEST] = [2, 2, 12];

interface Props {
  creature: Creature;
  query: URLSearchParams;
}

export function FamilyCard({ creature, query }: Props) {
  const sha = creature.sha256;
  const back = Math.min(FARTHEST, Math.max(1, Math.round(Number(query.get("back")) || NEAR)));
  const { value, error } = useFetched(() => api.readFamily(sha, back), [sha, back]);
  const tree = useMemo(() => value && familyLayoutOf(selfOf(creature), ...value), [creature, value]);
  const run = query.get("run");
  // Through a share of one creature its ancestors are told of, and not shown.
  const hrefOf = (name: string) =>
    sharedSlug && !run ? null : pageUrl(`/creatures/${name}${run ? `?run=${run}` : ""}`);
  const credited = value ? creditOf(value[0].items, creature) : [];
  const lost = value?.[0].items.some(({ kept }) => !kept);
  return (
    <section class="card" aria-labelledby="family-title">
      <div class="card-head">
        <h2 id="family-title">{sharedSlug ? "Ancestors" : "Parents and children"}</h2>
        <span class="spring" />
        {value?.[0].more && back < FARTHEST && (
          <button onClick={() => setQuery({ back: String(back + FURTHER) })}>Further back</button>
        )}
      </div>
      {error && <p class="banner wrong">{error} Load the page again to try once more.</p>}
      {!value && !error && <p class="quiet loading">Looking for relatives …</p>}
      {tree && tree.kin.length === 1 && (
        <p class="quiet">
          {creature.provenance
            ? `It has no parents${sharedSlug ? "" : ", and no child of it has become an elite"}.`
            : "It was brought here without its origin, and nothing has come of it yet."}
        </p>
      )}
      {tree && tree.kin.length > 1 && <FamilyTree {...{ tree, hrefOf }} self={sha} />}
      {credited.length > 0 && <p class="quiet small">Its ancestors are by {credited.join(", ")}.</p>}
      {tree && (lost || tree.hidden > 0) && (
        <p class="quiet small">
          {lost && "Dashed: never an elite, so only the name was kept. "}
          {tree.hidden > 0 && `${count(tree.hidden)} more children, less fit, are not drawn.`}
        </p>
      )}
    </section>
  );
}

/** Whom its ancestors' files ask to name, with their licences, beside its own credit. */
function creditOf(ancestors: Relative[], { credit }: Creature): string[] {
  const named = ancestors.flatMap(({ credit, licence }) =>
    (credit ?? []).map((name) => [name, `${name} (${licence})`] as const),
  );
  const others = named.filter(([name]) => !credit?.includes(name));
  return [...new Set(others.map(([, text]) => text))];
}

function selfOf({ sha256, measured, provenance }: Creature): Relative {
  return {
    creature: sha256,
    distance: 0,
    kept: true,
    parents: provenance?.parents ?? [],
    operator: provenance?.operator ?? null,
    generation: provenance?.generation ?? null,
    fitness: measured?.fitness ?? null,
    licence: null,
    credit: [],
  };
}
