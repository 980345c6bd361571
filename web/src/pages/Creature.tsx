/** One creature: its motion, its network, what was measured, where it comes from. */

import { useEffect, useMemo } from "preact/hooks";
import * as api from "../api/client";
import { messageOf } from "../api/problem";
import type { Creature, Spec } from "../api/types";
import type { Replay } from "../frames/replay";
import { useFetched } from "../live/fetching";
import { tell } from "../live/toasts";
import { number, short, words } from "../view/format";
import { isFree } from "../view/coupling";
import { NotFree } from "../view/NotFree";
import { ReplayPlayer } from "../view/replay/ReplayPlayer";
import { AuditCard } from "./Audit";
import { Facts } from "./Facts";
import { Genome } from "./Genome";
import { Pictures } from "./Pictures";
import { Refine } from "./Refine";
import { Rendering, useReplays } from "./rendering";

interface Props {
  sha: string;
  query: URLSearchParams;
}

export function CreaturePage({ sha, query }: Props) {
  const { value: creature, error } = useFetched(() => api.readCreature(sha), [sha]);
  useEffect(() => {
    document.title = `Creature ${short(sha)} · Microcosmos`;
  }, [sha]);
  const run = query.get("run");
  return (
    <main>
      <nav class="crumbs" aria-label="Where you are">
        <a href="/">Runs</a>
        {run && <a href={`/runs/${run}`}>{short(run)}</a>}
      </nav>
      <header class="page-head">
        <h1>
          {creature?.identity.genome.encoding === "gait"
            ? words(creature.identity.genome.swimmer)
            : "Creature"}{" "}
          <code>{short(sha)}</code>
        </h1>
        {creature && !isFree(creature.identity.world.coupling) && <NotFree />}
        <span class="spring" />
        {creature && searched(creature) && <Refine creature={creature} run={run} />}
        {creature && <Sharing sha={sha} />}
      </header>
      {error && <p class="banner wrong">{error}</p>}
      {!creature && !error && <p class="quiet loading">Loading creature …</p>}
      {creature && (
        <div class="creature-columns">
          <Motion key={sha} creature={creature} />
          <div class="stack">
            <Genome sha={sha} genome={creature.identity.genome} />
            {swims(creature) && <AuditCard key={sha} sha={sha} query={query} />}
            <Facts creature={creature} run={run} />
          </div>
        </div>
      )}
    </main>
  );
}

/** Whether it moves by itself; what folds only takes a shape. */
const swims = ({ identity }: Creature) => identity.genome.encoding !== "fold";

/** Whether it has genes that evolve, and so a fitness to climb. */
const searched = (creature: Creature) =>
  swims(creature) && creature.identity.genome.encoding !== "gait";

function Sharing({ sha }: { sha: string }) {
  const copy = async () => {
    await navigator.clipboard.writeText(`${location.origin}/creatures/${sha}`);
    tell({ kind: "note", text: "Link copied." });
  };
  return (
    <span class="actions">
      <button onClick={() => copy().catch((error) => tell({ kind: "wrong", text: messageOf(error) }))}>
        Copy link
      </button>
      <a class="button primary" href={api.creatureFileUrl(sha)} download={`creature-${sha.slice(0, 12)}.json`}>
        Download file
      </a>
    </span>
  );
}

function Motion({ creature }: { creature: Creature }) {
  const { sha256: sha, identity } = creature;
  const rendering = useReplays([sha]);
  const replay = rendering.replays?.[0];
  const films = useMemo(() => (replay ? [{ replay }] : []), [replay]);
  return (
    <section class="card motion" aria-label="Replay">
      <Rendering {...rendering} what="Simulating this creature again to record its motion …" />
      {replay && <ReplayPlayer films={films} />}
      {replay && swims(creature) && <Difference replay={replay} task={identity.task} />}
      {replay && <Pictures sha={sha} />}
    </section>
  );
}

function Difference({ replay, task }: { replay: Replay; task: Spec }) {
  const { recorded, replayed, difference } = replay.header.fitness;
  const swims = task.fitness === "displacement";
  return (
    <p class="quiet small">
      In this replay {swims ? "it swims" : "its fitness is"} {number(replayed, 4)}
      {swims && " cells"}
      {recorded !== null && `; its recorded fitness is ${number(recorded, 4)}`}
      {difference !== null && difference !== 0 && ` (rounding: ${number(difference, 2)})`}.
    </p>
  );
}

