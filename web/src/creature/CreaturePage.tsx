/** The page of a creature: motion, network, measures and origin. */

import { useEffect, useMemo } from "preact/hooks";
import * as api from "../api/client";
import type { Creature, Spec, Json } from "../api/types";
import type { Replay } from "../decode/replay";
import { useFetched } from "../store/fetch";
import { usePoseStream } from "../store/poses";
import { number, shortId, words } from "../ui/format";
import { NotForceFree, isForceFree } from "../ui/coupling";
import { Page, reasonOf, useTitle } from "../ui/Page";
import { TrustBadge } from "../ui/TrustBadge";
import { ReplayPlayer } from "../replay/ReplayPlayer";
import { newPlayhead } from "../replay/clock";
import { AUDIT_HASH, AuditCard, type AuditState, useAudit } from "./AuditCard";
import { FactsCard } from "./FactsCard";
import { FamilyCard } from "./FamilyCard";
import { BreedCreature } from "../breeding/BreedButton";
import { ForkLink } from "../ui/links";
import { GenomeCard } from "./GenomeCard";
import { LiveCard } from "./LiveCard";
import type { Others } from "./live/LiveView";
import { LatestCreatures, NamedCreature } from "../replay/OtherCreatures";
import { Downloads } from "./Downloads";
import { PlanCard } from "./PlanCard";
import { RemeasureCard } from "./RemeasureCard";
import { SavePage } from "./Downloads";
import { PublishButton } from "../publish/PublishButton";
import { SwimmingBody } from "../replay/SwimmingBody";
import { ReplayStatus, useReplays } from "../replay/replays";
import { SpaceTimeCard } from "./SpaceTimeCard";
import { VerifyCard } from "./VerifyCard";
import { isEvolved, swims } from "./kinds";
import { text } from "./text";
import "./creature.css";
import "./details.css";
import { useRefusal } from "../store/principal";
import { applyResponse } from "../store/store";
import { showFailure } from "../store/toasts";
import { navigate } from "../store/router";
import { ConfirmButton } from "../ui/ConfirmButton";
import { newIdempotencyKey } from "../ui/forms";

export function CreaturePage({ id: sha, query }: { id: string; query: URLSearchParams }) {
  const { value: creature, error } = useFetched(() => api.readCreature(sha), [sha]);
  useTitle(text.title(shortId(sha)));
  const audit = useAudit(sha);
  const run = query.get("run");
  return (
    <Page crumbs={[["/", text.runs], ...(run ? [[`/runs/${run}`, shortId(run)] as const] : [])]}>
      <header class="page-head">
        <h1>
          {creature?.identity.genome.encoding === "gait"
            ? words(creature.identity.genome.swimmer)
            : text.creature}{" "}
          <code>{shortId(sha)}</code>
        </h1>
        {creature && !isForceFree(creature.identity.world.coupling) && <NotForceFree />}
        {creature && swims(creature) && audit.trusted !== undefined && (
          <TrustBadge trusted={audit.trusted} href={AUDIT_HASH} />
        )}
        <span class="spring" />
        {creature && swims(creature) && (
          <a class="button" href={`/compare?creatures=${sha}`}>
            {text.sideBySide}
          </a>
        )}
        {creature && <PublishButton of={{ creature: sha }} file={creature} title="" />}
        {creature && run && isEvolved(creature) && <BreedCreature run={run} creature={sha} />}
        {creature && isEvolved(creature) && <ForkLink run={run} creatures={[sha]} title={text.fork} />}
        {creature && isEvolved(creature) && <RefineButton creature={creature} run={run} />}
      </header>
      {error && <p class="banner wrong">{reasonOf(error, sha)}</p>}
      {!creature && !error && <p class="quiet loading">{text.loading}</p>}
      {creature && <CreatureView key={sha} {...{ creature, query, audit }} />}
    </Page>
  );
}

interface ViewProps {
  creature: Creature;
  query: URLSearchParams;
  /** Missing in a share, whose visitors cannot start an audit. */
  audit?: AuditState;
  /** Title and address of a share. */
  title?: string;
  address?: string | null;
}

/** All cards of a creature; they share the playhead of its replay. */
export function CreatureView({ creature, query, audit, title, address = null }: ViewProps) {
  const { sha256: sha, identity } = creature;
  const readInputs = () => api.readEvaluation(sha);
  const playhead = useMemo(newPlayhead, []);
  const rendering = useReplays([sha]);
  const replay = rendering.replays?.[0] ?? null;
  const { stream } = usePoseStream(replay ? null : sha);
  const panels = useMemo(() => (replay ? [{ replay }] : []), [replay]);
  useEffect(() => {
    // The browser looked for the card before the page had its cards and its height.
    if (location.hash === AUDIT_HASH) document.querySelector(AUDIT_HASH)?.scrollIntoView();
  }, [replay]);
  return (
    <>
      <KeyFacts creature={creature} />
      <div class="creature-columns">
        <div class="motion stack">
          <section class="card" aria-label={text.replay}>
            <ReplayStatus {...rendering} what={text.recording}>
              {stream && <SwimmingBody stream={stream} label={text.swimming} path />}
            </ReplayStatus>
            {replay && <ReplayPlayer {...{ panels, playhead, query }} />}
            {replay && swims(creature) && <ReplayFitness replay={replay} task={identity.task} />}
            <Downloads sha={sha}>
              <SavePage title={title ?? text.title(shortId(sha))} {...{ creature, address }} />
            </Downloads>
          </section>
          {swims(creature) && <LiveCard readInputs={readInputs} others={audit && othersOf(sha)} />}
        </div>
        <div class="stack">
          {replay && <SpaceTimeCard {...{ replay, query, playhead }} />}
          {"plan" in identity.genome && <PlanCard sha={sha} />}
          <GenomeCard {...{ creature, playhead }} every={replay?.header.every ?? null} />
          <FamilyCard {...{ creature, query }} />
          {creature.measured && <RemeasureCard sha={sha} />}
          {creature.measured && <VerifyCard measured={creature.measured} readInputs={readInputs} />}
          {swims(creature) && audit && <AuditCard {...audit} />}
        </div>
      </div>
      <FactsCard creature={creature} />
    </>
  );
}

/** Creatures that may join another in live water: visitors of a share can read none. */
const othersOf = (sha: string): Others => ({
  readInputs: api.readEvaluation,
  pick: (onPick) => (
    <>
      <NamedCreature onPick={onPick} />
      <LatestCreatures except={[sha]} onPick={onPick} />
    </>
  ),
});

/** The fitness and the birth of a creature, in one line. */
function KeyFacts({ creature: { measured, provenance, identity } }: { creature: Creature }) {
  const facts = [
    ...(measured ? [text.reached(number(measured.fitness, 3), identity.task.fitness)] : []),
    ...(provenance && identity.genome.encoding !== "gait"
      ? [text.born(provenance.generation, provenance.operator)]
      : []),
  ];
  return facts.length > 0 ? <p class="quiet key-facts">{facts.join(" · ")}</p> : null;
}

function ReplayFitness({ replay, task }: { replay: Replay; task: Spec }) {
  const { recorded, replayed, difference } = replay.header.fitness;
  return (
    <p class="quiet small">
      {text.replayFitness(replayed === null ? null : number(replayed, 4), task.fitness)}
      {recorded !== null && text.recordedFitness(number(recorded, 4))}
      {difference !== null && difference !== 0 && text.rounding(number(difference, 2))}.
    </p>
  );
}

interface RefineProps {
  creature: Creature;
  /** The run whose cells bound the refinement, if the page was opened from one. */
  run: string | null;
}

/** The button that starts a refinement run from a creature. */
function RefineButton({ creature, run }: RefineProps) {
  const refusal = useRefusal();
  if (refusal) return null;
  const start = async () => {
    try {
      const archive = run ? (await api.readRun(run)).spec.archive : undefined;
      const spec = {
        experiment: "refinement",
        creature: creature as unknown as Json,
        ...(archive !== undefined && { archive }),
      };
      const made = await applyResponse("change", api.createRun(spec, newIdempotencyKey(), null));
      navigate(`/runs/${made.id}`);
    } catch (error) {
      showFailure(error);
    }
  };
  return (
    <ConfirmButton verb={text.refine} what={text.refineWhat} queues={text.refineAbout} onConfirm={start} />
  );
}
