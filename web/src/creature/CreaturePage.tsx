/** One creature: its motion, its network, what was measured, where it comes from. */

import { useEffect, useMemo } from "preact/hooks";
import * as api from "../api/client";
import { share } from "../api/address";
import type { Creature, Spec } from "../api/types";
import type { Replay } from "../decode/replay";
import { useFetched } from "../store/fetch";
import { setQuery } from "../store/router";
import { number, short, words } from "../ui/format";
import { isFree } from "../ui/coupling";
import { NotFree } from "../ui/NotForceFree";
import { ReplayPlayer } from "../replay/ReplayPlayer";
import { lookOf, queryOf } from "../replay/look";
import { newMoment } from "../replay/moment";
import { AuditCard } from "./AuditCard";
import { Facts } from "./FactsCard";
import { Family } from "./FamilyCard";
import { ForkLink } from "../ui/ForkLink";
import { Genome } from "./GenomeCard";
import { Keep } from "./Downloads";
import { MeasuredCard } from "./RemeasureCard";
import { Publish } from "../publish/PublishButton";
import { Refine } from "./RefineButton";
import { Rendering, useReplays } from "../replay/recordings";
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
        {creature && !isFree(creature.identity.world.coupling) && <NotFree />}
        <span class="spring" />
        {creature && <Publish of={{ creature: sha }} file={creature} title="" />}
        {creature && searched(creature) && (
          <ForkLink run={run} creature={sha} title="A new run that begins from this creature" />
        )}
        {creature && searched(creature) && <Refine creature={creature} run={run} />}
      </header>
      {error && <p class="banner wrong">{error}</p>}
      {!creature && !error && <p class="quiet loading">Loading creature …</p>}
      {creature && <Whole key={sha} {...{ creature, query }} />}
    </main>
  );
}

/** Everything about one creature, around one moment of its replay. */
export function Whole({ creature, query }: { creature: Creature; query: URLSearchParams }) {
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
            <Rendering {...rendering} what="Simulating this creature again to record its motion …" />
            {replay && (
              <ReplayPlayer
                {...{ films, moment }}
                look={lookOf(query)}
                onLook={(change) => setQuery(queryOf(change))}
              />
            )}
            {replay && swims(creature) && <Difference replay={replay} task={identity.task} />}
            <Keep sha={sha} />
          </section>
        </div>
        <div class="stack">
          {replay?.drive && <SpaceTimeCard {...{ replay, query, moment }} />}
          <Genome {...{ creature, moment }} every={replay?.header.every ?? null} />
          <Family {...{ creature, query }} />
          {creature.measured && <MeasuredCard sha={sha} />}
          {swims(creature) && !share && <AuditCard sha={sha} query={query} />}
        </div>
      </div>
      <Facts creature={creature} />
    </>
  );
}

/** Whether it moves by itself; what folds only takes a shape. */
const swims = ({ identity }: Creature) => identity.genome.encoding !== "fold";

/** Whether it has genes that evolve, and so a fitness to climb. */
const searched = (creature: Creature) => swims(creature) && creature.identity.genome.encoding !== "gait";

function Difference({ replay, task }: { replay: Replay; task: Spec }) {
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
