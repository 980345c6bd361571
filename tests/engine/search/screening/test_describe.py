"""Descriptions of creatures, beside their simulations."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import search
from microcosmos.search.screening import PHASES, describe

CHAIN = {"body": {"nodes": 12}, "control": {"period": 40}, "task": {"steps": 600}}
ZOO = {
    "body": {"builder": "grown"},
    "control": {"encoding": "body-graph"},
    "task": {"steps": 600},
}


def newcomers(task, count):
    keys = jax.random.split(jax.random.key(5), count)
    return jax.jit(jax.vmap(lambda key: task.encoding.newcomer(key=key)))(keys)


@pytest.mark.long
@pytest.mark.parametrize("free", [{}, {"max_speed": None, "lag": 0, "max_bend": None}])
def test_a_stroke_repeats_the_rest_shapes_of_the_simulation(strokes_of, free):
    """Once the ramp is over, at equal phases of the clock; the simulation interpolates."""
    strokes = strokes_of(**{**CHAIN, "control": {"period": 64, **free}})
    genotypes = newcomers(strokes.task, 6)

    def both(genotype):
        driven = search.drive(strokes.task, genotype)
        _, stroke = strokes.of(genotype)
        clock = jnp.arange(1.0, 601.0) if driven.clock is None else driven.clock
        return driven.inputs.angle, clock, stroke.rest.angle, jnp.sum(stroke.took)

    angle, clock, sketched, took = jax.jit(lambda g: jax.lax.map(both, g))(genotypes)
    for number in range(6):
        # Phase p stands for the command of step p · period / PHASES.
        at = 128 + 64 * np.arange(PHASES) / PHASES + 1
        if clock[number, -1] < at[-1]:
            continue
        seen = [np.interp(at, clock[number], one) for one in angle[number].T]
        np.testing.assert_allclose(np.stack(seen, 1), sketched[number], atol=0.08)
        steps = np.interp([128, 192], clock[number], np.arange(1, 601))
        assert float(took[number]) == pytest.approx(np.diff(steps)[0], rel=0.15)


SCHOOL = CHAIN | {
    "world": {"width": 64, "height": 64, "copies": {"arrangement": "column", "spacing": 16}}
}


@pytest.mark.long
@pytest.mark.parametrize("parts", [CHAIN, ZOO, SCHOOL])
def test_known_measures_are_those_of_the_simulation(strokes_of, parts):
    strokes = strokes_of(**parts)
    names = ("free_ends", "total_length", "nodes", "connections", "hidden_nodes", "speed")
    genotypes = newcomers(strokes.task, 4)

    def both(genotype):
        found = search.evaluate(strokes.task, genotype)
        return describe(strokes, names, genotype), found.measures

    described, measures = jax.jit(lambda g: jax.lax.map(both, g))(genotypes)
    columns = [search.MEASURES.index(name) for name in names]
    known, measured = np.asarray(described.known), np.asarray(measures)[:, columns]
    np.testing.assert_allclose(known[:, :-1], measured[:, :-1], rtol=1e-6)
    assert np.all(np.isnan(known[:, -1]))
    assert np.all(np.isfinite(described.inputs))
