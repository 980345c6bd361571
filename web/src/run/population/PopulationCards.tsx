/** Cards of neuroevolution: the species over time, and the best network so far. */

import { useMemo } from "preact/hooks";
import * as api from "../../api/client";
import type { Run } from "../../api/types";
import { networkOf } from "../../decode/network";
import { type Elites, fittest } from "../../store/elites";
import { useFetched, useSpecies } from "../../store/fetch";
import { number, shortId } from "../../ui/format";
import { Card } from "../../ui/Page";
import { NetworkGraph } from "../../creature/NetworkGraph";
import { SpeciesPlot } from "./SpeciesPlot";
import { text } from "./text";
import "./population.css";

export function PopulationCards({ run, elites }: { run: Run; elites: Elites }) {
  return (
    <div class="run-columns even">
      <SpeciesCard run={run} />
      <BestNetwork run={run} elites={elites} />
    </div>
  );
}

function SpeciesCard({ run }: { run: Run }) {
  const { value, error } = useSpecies(run);
  const hasSpecies = value !== null && value.generation.length > 0;
  return (
    <Card id="species" title={text.species}>
      {error && <p class="wrong-text small">{error}</p>}
      {hasSpecies && <SpeciesPlot history={value} />}
      {value && !hasSpecies && (
        <p class="quiet waiting">{run.generation === 0 ? text.noSpeciesYet : text.noSpecies}</p>
      )}
    </Card>
  );
}

function BestNetwork({ run, elites }: { run: Run; elites: Elites }) {
  const best = useMemo(() => fittest(elites)?.[1] ?? null, [elites]);
  const sha = best?.creature ?? null;
  const { value, error } = useFetched(async () => (sha ? await readGraph(sha) : null), [sha]);
  const note = best && (
    <>
      {text.bestOf(number(best.fitness, 4), best.generation)}{" "}
      <a href={`/creatures/${best.creature}?run=${run.id}`}>
        <code>{shortId(best.creature)}</code>
      </a>
    </>
  );
  return (
    <Card id="network" title={text.bestNetwork} note={note}>
      {error && <p class="wrong-text small">{error}</p>}
      {!best && <p class="quiet waiting">{text.noBest}</p>}
      {value === "none" && <p class="quiet">{text.noNetwork}</p>}
      {value && value !== "none" && <NetworkGraph {...value} />}
    </Card>
  );
}

async function readGraph(sha: string) {
  const { genome } = (await api.readCreature(sha)).identity;
  if (!("nodes" in genome)) return "none";
  return { network: networkOf(genome), positions: await api.readNetwork(sha) };
}
