/** Cards of neuroevolution: the species over time, and the best network so far. */

import { useMemo } from "preact/hooks";
import * as api from "../../api/client";
import type { Genes, Genome, Run } from "../../api/types";
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
  const { value, error } = useFetched(async () => (sha ? await api.readCreature(sha) : null), [sha]);
  const genome = value?.identity.genome;
  const network = useMemo(() => (genome && isNetwork(genome) ? networkOf(genome) : null), [genome]);
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
      {network && <NetworkGraph network={network} />}
      {genome && !network && <p class="quiet">{text.noNetwork}</p>}
    </Card>
  );
}

const isNetwork = (genome: Genome): genome is Genes => "nodes" in genome;
