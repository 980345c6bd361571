"""QDax's MAP-Elites with our NEAT as its emitter, on swimmers that networks control.

Needs `pip install "microcosmos[qdax]"`.
"""

from typing import Any

import jax
import jax.numpy as jnp
from qdax.core.map_elites import MAPElites

import microcosmos
from microcosmos import build
from microcosmos.search.qdax import NeatEmitter

SPEC = {
    "experiment": "quality-diversity",
    "world": {"width": 32, "height": 32},
    "body": {"nodes": 12},
    "control": {"period": 50},
    "task": {"steps": 100},
}


def main(generations: int = 20, batch: int = 32, **changes: Any) -> Any:
    """The repertoire after so many generations; its genotypes are networks."""
    microcosmos.prepare()
    spec = microcosmos.parse(SPEC | {"search": {"batch": batch}} | changes)
    plan = build.build_plan(spec)
    (neat,) = plan.emitters
    keys = jax.random.split(jax.random.PRNGKey(0), batch + 2)
    first = jax.vmap(lambda key: plan.encoding.newcomer(key=key))(keys[2:])
    search = MAPElites(
        scoring_function=jax.jit(microcosmos.scoring_function(spec)),
        emitter=NeatEmitter(neat),
        metrics_function=lambda repertoire: {},
    )
    repertoire, state, _ = search.init(first, jnp.asarray(plan.cells.centres), keys[0])
    update = jax.jit(search.update)
    for key in jax.random.split(keys[1], generations - 1):
        repertoire, state, _ = update(repertoire, state, key)
    found = jnp.isfinite(repertoire.fitnesses[:, 0])
    hidden = jnp.sum(repertoire.genotypes.node_used[found], 1)
    print(f"{int(jnp.sum(found))} elites; networks of {hidden.min()} to {hidden.max()} nodes")
    return repertoire


if __name__ == "__main__":
    main()
