/** Creatures side by side: their motion with one clock, and what differs between them. */

import { useState } from "preact/hooks";
import * as api from "../api/client";
import type { Creature } from "../api/types";
import { groupsOf, originOf } from "../creature/facts";
import { LatestCreatures, NamedCreature } from "../replay/OtherCreatures";
import { useFetched } from "../store/fetch";
import { readTankBatch, usePoses } from "../store/poses";
import { setQuery } from "../store/router";
import { Card, Page } from "../ui/Page";
import { DASH, shortId } from "../ui/format";
import { MAX_SIDE_BY_SIDE } from "../ui/links";
import { ComparisonTable, type Row } from "./ComparisonTable";
import { Race } from "./Race";
import { text } from "./text";
import "./creatures.css";

const setCreatures = (names: string[]) => setQuery({ creatures: names.join() });

export function CreaturesPage({ query }: { query: URLSearchParams }) {
  const requested = [...new Set((query.get("creatures") ?? "").split(",").filter(Boolean))];
  const names = requested.slice(0, MAX_SIDE_BY_SIDE);
  const { value: creatures, error } = useFetched(
    () => Promise.all(names.map((name) => api.readCreature(name))),
    [names.join()],
  );
  const poses = usePoses(
    readTankBatch,
    names.map((creature) => ({ creature })),
  );
  const lanes = names.flatMap((name) => {
    const stream = poses.get(name);
    return stream ? [{ name: shortId(name), stream }] : [];
  });
  return (
    <Page title={text.sideBySide} crumbs={[["/", text.runs]]} error={error}>
      {requested.length > MAX_SIDE_BY_SIDE && (
        <p class="banner warning">{text.tooManyCreatures(MAX_SIDE_BY_SIDE, requested.length)}</p>
      )}
      <Chosen names={names} />
      {lanes.length > 0 && <Race key={names.join()} lanes={lanes} />}
      {lanes.length < names.length && <p class="quiet">{text.recording(names.length - lanes.length)}</p>}
      {names.length < MAX_SIDE_BY_SIDE && (
        <LatestCreatures except={names} onPick={(name) => setCreatures([...names, name])} />
      )}
      {creatures && creatures.length > 0 && <Facts creatures={creatures} />}
    </Page>
  );
}

function Chosen({ names }: { names: string[] }) {
  return (
    <div class="row chosen">
      <ul class="compare-legend" aria-label={text.creatures}>
        {names.map((name) => (
          <li key={name}>
            <a href={`/creatures/${name}`}>
              <code>{shortId(name)}</code>
            </a>
            <button
              class="plain small-button"
              aria-label={text.remove(shortId(name))}
              onClick={() => setCreatures(names.filter((each) => each !== name))}
            >
              ✕
            </button>
          </li>
        ))}
      </ul>
      {names.length < MAX_SIDE_BY_SIDE && <NamedCreature onPick={(name) => setCreatures([...names, name])} />}
    </div>
  );
}

/** Measures, body, network and origin of each creature: by default what differs. */
function Facts({ creatures }: { creatures: Creature[] }) {
  const [all, setAll] = useState(false);
  const rows = rowsOf(creatures);
  const shown = all ? rows : rows.filter(({ values }) => new Set(values).size > 1);
  const columns = creatures.map(({ sha256 }) => <code>{shortId(sha256)}</code>);
  return (
    <Card
      id="facts"
      title={all ? text.facts : text.factDifferences}
      actions={
        creatures.length > 1 && (
          <button onClick={() => setAll(!all)}>{all ? text.onlyDifferences : text.allFacts}</button>
        )
      }
    >
      <ComparisonTable
        {...{ label: text.facts, corner: text.fact, columns }}
        rows={creatures.length > 1 ? shown : rows}
      />
    </Card>
  );
}

export function rowsOf(creatures: Creature[]): Row[] {
  const facts = creatures.map(
    (creature) => new Map([...groupsOf(creature).flatMap(({ rows }) => rows), ...originOf(creature)]),
  );
  const titles = [...new Set(facts.flatMap((each) => [...each.keys()]))];
  const rows = titles.map((title) => ({ title, values: facts.map((each) => each.get(title) ?? DASH) }));
  const common = commonGenes(creatures);
  return common ? [...rows, { title: text.commonGenes, values: common }] : rows;
}

/**
 * For each creature, how many of its connections the first one has too: those with equal innovation
 * numbers, which come from one ancestor. Null if the first one has no such genes.
 */
export function commonGenes([first, ...others]: Creature[]): string[] | null {
  const own = first && innovationsOf(first);
  if (!own || others.length === 0) return null;
  const known = new Set(own);
  return [first, ...others].map((creature) => {
    const genes = innovationsOf(creature);
    return genes ? text.of(genes.filter((gene) => known.has(gene)).length, genes.length) : DASH;
  });
}

function innovationsOf({ identity: { genome } }: Creature): number[] | null {
  return "connections" in genome ? genome.connections.innovation : null;
}
