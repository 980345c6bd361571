"""QDax's CMA-MEGA on our creatures, fed with the simulator's own slopes.

Needs `pip install "microcosmos[qdax]"`. Our own, which runs for weeks and is taken up again,
is the emitter `cma-mega` of any search.
"""

from typing import Any

import jax
import jax.numpy as jnp
from qdax.core.emitters.cma_mega_emitter import CMAMEGAEmitter
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


def main(generations: int = 20, batch: int = 32, step: float = 0.5, **changes: Any) -> Any:
    """The repertoire after so many generations."""
    microcosmos.prepare()
    spec = microcosmos.parse(SPEC | changes)
    plan = build.build_plan(spec)
    keys = jax.random.split(jax.random.PRNGKey(0), batch + 2)
    first = jax.vmap(lambda key: plan.encoding.newcomer(key=key).values)(keys[2:])
    centroids = jnp.asarray(plan.cells.centres)
    emitter = CMAMEGAEmitter(
        scoring_function=jax.jit(microcosmos.scoring_function(spec, slopes=True)),
        batch_size=batch,
        learning_rate=1.0,
        num_descriptors=len(spec.archive.descriptors),
        centroids=centroids,
        sigma_g=step,
    )
    search = MAPElites(
        scoring_function=jax.jit(microcosmos.scoring_function(spec)),
        emitter=emitter,
        metrics_function=lambda repertoire: {},
    )
    repertoire, state, _ = search.init(first, centroids, keys[0])
    for key in jax.random.split(keys[1], generations - 1):
        repertoire, state, _ = search.update(repertoire, state, key)
    fitness = repertoire.fitnesses[:, 0]
    elites = int(jnp.sum(jnp.isfinite(fitness)))
    print(f"{elites} elites in {len(fitness)} cells; the best swims {fitness.max():.3f} cells")
    return repertoire


if __name__ == "__main__":
    main()
