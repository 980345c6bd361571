"""QDax's MAP-Elites on our creatures: directly encoded swimmers, iso+line variation.

Needs `pip install "microcosmos[qdax]"`.
"""

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from qdax.core.emitters.mutation_operators import isoline_variation
from qdax.core.emitters.standard_emitters import MixingEmitter
from qdax.core.map_elites import MAPElites

import microcosmos
from microcosmos import build

SPEC = {
    "experiment": "quality-diversity",
    "world": {"width": 32, "height": 32},
    "body": {"nodes": 12},
    "control": {"encoding": "direct", "period": 50},
    "task": {"steps": 100},
    "search": {"emitters": [{"operator": "iso+line"}]},
}


def main(generations: int = 20, batch: int = 32, **changes: Any) -> Any:
    """The repertoire after so many generations."""
    microcosmos.prepare()
    spec = microcosmos.parse(SPEC | changes)
    plan = build.build_plan(spec)
    keys = jax.random.split(jax.random.PRNGKey(0), batch + 2)
    first = jax.vmap(lambda key: plan.encoding.newcomer(key=key).values)(keys[2:])
    variation = partial(
        isoline_variation, iso_sigma=0.02, line_sigma=0.2, minval=-1.0, maxval=1.0
    )
    search = MAPElites(
        scoring_function=jax.jit(microcosmos.scoring_function(spec)),
        emitter=MixingEmitter(lambda genes, key: genes, variation, 1.0, batch),
        metrics_function=lambda repertoire: {},
    )
    centroids = jnp.asarray(plan.cells.centres)
    repertoire, state, _ = search.init(first, centroids, keys[0])
    for key in jax.random.split(keys[1], generations - 1):
        repertoire, state, _ = search.update(repertoire, state, key)
    fitness = repertoire.fitnesses[:, 0]
    elites = int(jnp.sum(jnp.isfinite(fitness)))
    print(f"{elites} elites in {len(fitness)} cells; the best swims {fitness.max():.3f} cells")
    return repertoire


if __name__ == "__main__":
    main()
