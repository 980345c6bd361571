"""The estimated memory of a spec is an upper bound for its compiled programs."""

import jax
import jax.numpy as jnp
import pytest

from microcosmos import search
from microcosmos.build import build, build_task
from microcosmos.spec import estimate, parse

SPECS = {
    "ordinary": {},
    "large networks": {"genome": {"max_nodes": 200, "max_connections": 400}},
    "large world": {"world": {"width": 256, "height": 256}},
    "long": {"task": {"steps": 5000}},
}


def taken(program, *arguments) -> int:
    sizes = program.lower(*arguments).compile().memory_analysis()
    return sizes.temp_size_in_bytes + sizes.output_size_in_bytes


@pytest.mark.parametrize(
    "name",
    ["ordinary", *(pytest.param(name, marks=pytest.mark.long) for name in list(SPECS)[1:])],
)
def test_programs_take_no_more_than_was_estimated(name):
    spec = parse({"experiment": "quality-diversity", **SPECS[name]})
    run = build(spec)
    state = run.init()
    networks = jax.tree.map(lambda x: x[: spec.search.block], state.elites.genotypes)
    task = build_task(spec.scene, room=run.facts.encoding.room)
    batched = jax.jit(jax.vmap(lambda network: search.evaluate(task, network)))
    given = (state.emitters, state.elites, state.counters, jnp.asarray(1))
    together = taken(run.plan.steps.emission, *given)
    together += max(taken(run.plan.evaluate.run, networks), taken(batched, networks))
    assert together <= estimate(spec).memory_bytes
