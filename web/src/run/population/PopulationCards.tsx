/** A population that evolves networks: its species over time, and the best network so far. */

import { useMemo } from "preact/hooks";
import * as api from "../../api/client";
import type { Genes, Genome, Run } from "../../api/types";
import { networkOf } from "../../decode/network";
import type { Elites } from "../../store/elites";
import { useFetched } from "../../store/fetch";
import { useSpecies } from "../../store/runPage";
import { number, short } from "../../ui/format";
import { NetworkGraph } from "../../creature/NetworkGraph";
import { SpeciesPlot } from "./SpeciesPlot";
import "./population.css";

export function PopulationCards({ run, elites }: { run: Run; elites: Elites }) {
  return (
    <div class="population">
      <SpeciesCard run={run} />
      <BestNetwork run={run} elites={elites} />
    </div>
  );
}

function SpeciesCard({ run }: { run: Run }) {
  const { value, error } = useSpecies(run);
  const some = value !== null && value.generation.length > 0;
  return (
    <section class="card" id="species" aria-labelledby="species-title" tabIndex={-1}>
      <h2 id="species-title">Species over time</h2>
      {error && <p class="wrong-text small">{error}</p>}
      {some && <SpeciesPlot history={value} />}
      {value && !some && (
        <p class="quiet waiting">
          {run.generation === 0
            ? "They begin with the first generation."
            : "No species were recorded: the run is of an older version, or its search keeps none."}
        </p>
      )}
    </section>
  );
}

function BestNetwork({ run, elites }: { run: Run; elites: Elites }) {
  const best = useMemo(
    () =>
      [...elites.values()].reduce((a, b) => (b.fitness > (a?.fitness ?? -Infinity) ? b : a), null as Best),
    [elites],
  );
  const sha = best?.creature ?? null;
  const { value, error } = useFetched(async () => (sha ? await api.readCreature(sha) : null), [sha]);
  const genome = value?.identity.genome;
  const network = useMemo(() => (genome && isNetwork(genome) ? networkOf(genome) : null), [genome]);
  return (
    <section class="card" id="network" aria-labelledby="best-title" tabIndex={-1}>
      <div class="card-head wraps">
        <h2 id="best-title">Best network so far</h2>
        {best && (
          <span class="quiet">
            fitness {number(best.fitness, 4)}, of generation {best.generation},{" "}
            <a href={`/creatures/${best.creature}?run=${run.id}`}>
              <code>{short(best.creature)}</code>
            </a>
          </span>
        )}
      </div>
      {error && <p class="wrong-text small">{error}</p>}
      {!best && <p class="quiet waiting">There is none before the first generation.</p>}
      {network && <NetworkGraph network={network} />}
      {genome && !network && <p class="quiet">Its genes are numbers: it has no network to draw.</p>}
    </section>
  );
}

type Best = { creature: string; fitness: number; generation: number } | null;

const isNetwork = (genome: Genome): genome is Genes => "nodes" in genome;
