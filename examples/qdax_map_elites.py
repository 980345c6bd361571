"""QDax's MAP-Elites on our creatures, with one of three emitters.

`iso+line` varies directly encoded swimmers, `cma-mega` climbs the simulator's own slopes, and
`neat` is our NEAT, on swimmers that networks control. Needs `pip install "microcosmos[qdax]"`.
"""

import sys
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from qdax.core.emitters.cma_mega_emitter import CMAMEGAEmitter
from qdax.core.emitters.mutation_operators import isoline_variation
from qdax.core.emitters.standard_emitters import MixingEmitter
from qdax.core.map_elites import MAPElites

import microcosmos
from microcosmos import build
from microcosmos.search.qdax import NeatEmitter

SPEC = {
    "experiment": "quality-diversity",
    "world": {"width": 32, "height": 32},
    "body": {"nodes": 12},
    "task": {"steps": 100},
}
DIRECT = {
    "control": {"encoding": "direct", "period": 50},
    "search": {"emitters": [{"operator": "iso+line"}]},
}


def main(
    emitter: str = "iso+line", generations: int = 20, batch: int = 32, **changes: Any
) -> Any:
    """Return the repertoire after `generations`."""
    microcosmos.prepare()
    network = {"control": {"period": 50}, "search": {"batch": batch}}
    spec = microcosmos.parse(SPEC | (network if emitter == "neat" else DIRECT) | changes)
    run = build.build(spec)
    plan = run.plan
    keys = jax.random.split(jax.random.PRNGKey(0), batch + 2)
    first = jax.vmap(lambda key: run.facts.encoding.newcomer(key=key))(keys[2:])
    centroids = jnp.asarray(plan.container.centres)
    search = MAPElites(
        scoring_function=jax.jit(microcosmos.scoring_function(spec)),
        emitter=emitter_of(emitter, spec, plan, batch, centroids),
        metrics_function=lambda repertoire: {},
    )
    genotypes = first if emitter == "neat" else first.values
    repertoire, state, _ = search.init(genotypes, centroids, keys[0])
    update = jax.jit(search.update) if emitter == "neat" else search.update
    for key in jax.random.split(keys[1], generations - 1):
        repertoire, state, _ = update(repertoire, state, key)
    fitness = repertoire.fitnesses[:, 0]
    elites = int(jnp.sum(jnp.isfinite(fitness)))
    print(f"{elites} elites in {len(fitness)} cells; the best swims {fitness.max():.3f} cells")
    return repertoire


def emitter_of(name: str, spec: Any, plan: Any, batch: int, centroids: Any) -> Any:
    if name == "neat":
        return NeatEmitter(plan.emitters[0])
    if name == "cma-mega":
        return CMAMEGAEmitter(
            scoring_function=jax.jit(microcosmos.scoring_function(spec, slopes=True)),
            batch_size=batch,
            learning_rate=1.0,
            num_descriptors=len(spec.archive.descriptors),
            centroids=centroids,
            sigma_g=0.5,
        )
    variation = partial(
        isoline_variation, iso_sigma=0.02, line_sigma=0.2, minval=-1.0, maxval=1.0
    )
    return MixingEmitter(lambda genes, key: genes, variation, 1.0, batch)


if __name__ == "__main__":
    main(*sys.argv[1:2])
