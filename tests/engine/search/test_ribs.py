"""pyribs: our creatures as its objective and measures."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import microcosmos
from microcosmos import build, search
from microcosmos.build.peers import ribs_results
from microcosmos.genomes import Vector

AXES = (
    search.Axis(measure=1, low=1e-2, high=1e2, bins=3, logarithmic=True),
    search.Axis(measure=0, low=-1.0, high=1.0, bins=4),
)
SPEC = {
    "experiment": "quality-diversity",
    "world": {"width": 24, "height": 24},
    "body": {"nodes": 6},
    "control": {"encoding": "direct", "terms": 1, "period": 20},
    "task": {"steps": 60},
    "search": {"batch": 4, "block": 4, "emitters": [{"operator": "iso+line"}]},
}


def test_what_is_infeasible_has_the_worst_objective_and_all_numbers_are_finite():
    fitness, status = jnp.asarray([0.5, 0.1, jnp.nan, 0.3]), jnp.asarray([0, 1, 0, 0])
    measured = jnp.asarray([[0.0, 1.0], [0.0, 1.0], [0.0, 1.0], [0.0, jnp.nan]])
    results = search.Evaluation(fitness, measured, status)
    objective, measures = ribs_results(results, AXES, -9.0)
    np.testing.assert_allclose(objective, [0.5, -9, -9, -9])
    np.testing.assert_allclose(measures, [[0.5, 0.5], [0, 0], [0, 0], [0, 0]])


def test_objectives_have_the_bits_of_our_own_evaluation():
    spec = microcosmos.parse(SPEC)
    run = build.build(spec)
    genes = run.plan.genotype.values.shape[0]
    vectors = np.random.default_rng(0).uniform(-0.3, 0.3, (6, genes)).astype("f4")
    function = microcosmos.ribs_function(spec, worst=-1.0)
    objective, measures = function(vectors)
    ends = np.sign(vectors)
    np.testing.assert_array_equal(function(7 * ends)[0], function(ends)[0], "Beyond ±1.")
    program = run.plan.evaluate.run
    genotypes = jax.device_get(Vector(jnp.asarray(vectors)))
    ours = search.judged(search.evaluate_blocks(program, genotypes, block=4))
    sound = ours.status == 0
    assert sound.any()
    assert np.where(sound, ours.fitness, np.float32(-1)).tobytes() == objective.tobytes()
    assert (measures >= 0).all()
    assert (measures <= 1).all()


def test_networks_are_refused():
    spec = microcosmos.parse({"experiment": "quality-diversity"})
    with pytest.raises(ValueError, match=r"`control.encoding` must be of numbers .* 'cppn'"):
        microcosmos.ribs_function(spec)
