/** One creature: its motion, its network, what was measured, where it comes from. */

import { useEffect, useMemo } from "preact/hooks";
import * as api from "../api/client";
import { sharedSlug } from "../api/address";
import type { Creature, Spec } from "../api/types";
import type { Replay } from "../decode/replay";
import { useFetched } from "../store/fetch";
import { setQuery } from "../store/router";
import { number, short, words } from "../ui/format";
import { isForceFree } from "../ui/coupling";
import { reasonOf } from "../ui/NotFound";
import { NotForceFree } from "../ui/NotForceFree";
import { ReplayPlayer } from "../replay/ReplayPlayer";
import { replayViewOf, queryOf } from "../replay/look";
import { newMoment } from "../replay/moment";
import { AuditCard } from "./AuditCard";
import { FactsCard } from "./FactsCard";
import { FamilyCard } from "./FamilyCard";
import { ForkLink } from "../ui/ForkLink";
import { GenomeCard } from "./GenomeCard";
import { Downloads } from "./Downloads";
import { RemeasureCard } from "./RemeasureCard";
import { PublishButton } from "../publish/PublishButton";
import { RefineButton } from "./RefineButton";
import { RecordingStatus, useReplays } from "../replay/recordings";
import { SpaceTimeCard } from "./SpaceTimeCard";
import "./creature.css";
import "./details.css";

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
        {creature && !isForceFree(creature.identity.world.coupling) && <NotForceFree />}
        <span class="spring" />
        {creature && <PublishButton of={{ creature: sha }} file={creature} title="" />}
        {creature && isEvolved(creature) && (
          <ForkLink run={run} creature={sha} title="A new run that begins from this creature" />
        )}
        {creature && isEvolved(creature) && <RefineButton creature={creature} run={run} />}
      </header>
      {error && <p class="banner wrong">{reasonOf(error, sha)}</p>}
      {!creature && !error && <p class="quiet loading">Loading creature …</p>}
      {creature && <CreatureView key={sha} {...{ creature, query }} />}
    </main>
  );
}

/** Everything about one creature, around one moment of its replay. */
export function CreatureView({ creature, query }: { creature: Creature; query: URLSearchParams }) {
  const { sha256: sha, identity } = creature;
  const moment = useMemo(newMoment, []);
  const rendering = useReplays([sha]);
  const replay = rendering.replays?.[0] ?? null;
  const films = useMemo(() => (replay ? [{ replay }] : []), [replay]);
  return (
    <>
      <div class="creature-columns">
        <div class="motion stack">
          <section class="card" aria-label="Replay">
            <RecordingStatus {...rendering} what="Simulating this creature again to record its motion …" />
            {replay && (
              <ReplayPlayer
                {...{ films, moment }}
                look={replayViewOf(query)}
                onLook={(change) => setQuery(queryOf(change))}
              />
            )}
            {replay && swims(creature) && <ReplayFitness replay={replay} task={identity.task} />}
            <Downloads sha={sha} />
          </section>
        </div>
        <div class="stack">
          {replay?.drive && <SpaceTimeCard {...{ replay, query, moment }} />}
          <GenomeCard {...{ creature, moment }} every={replay?.header.every ?? null} />
          <FamilyCard {...{ creature, query }} />
          {creature.measured && <RemeasureCard sha={sha} />}
          {swims(creature) && !sharedSlug && <AuditCard sha={sha} query={query} />}
        </div>
      </div>
      <FactsCard creature={creature} />
    </>
  );
}

/** Whether it moves by itself; what folds only takes a shape. */
const swims = ({ identity }: Creature) => identity.genome.encoding !== "fold";

/** Whether it has genes that evolve, and so a fitness to climb. */
const isEvolved = (creature: Creature) => swims(creature) && creature.identity.genome.encoding !== "gait";

function ReplayFitness({ replay, task }: { replay: Replay; task: Spec }) {
  const { recorded, replayed, difference } = replay.header.fitness;
  const swims = task.fitness === "displacement";
  return (
    <p class="quiet small">
      {replayed === null
        ? "This replay was made without the module that its fitness is of"
        : `In this replay ${swims ? "it swims" : "its fitness is"} ${number(replayed, 4)}`}
      {swims && " cells"}
      {recorded !== null && `; its recorded fitness is ${number(recorded, 4)}`}
      {difference !== null && difference !== 0 && ` (rounding: ${number(difference, 2)})`}.
    </p>
  );
}
