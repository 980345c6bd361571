"""A scene of chains whose shape is written by hand, and its strokes."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import search, spec
from microcosmos.build.scene import build_layout, build_task
from microcosmos.device import array

FREE = {"max_speed": None, "lag": 0, "max_bend": None}


@pytest.fixture(scope="session")
def strokes_of():
    """From parts of a spec to the strokes of its creatures."""

    def build(**parts):
        chosen = spec.QualityDiversity(**parts)
        scene = chosen.scene
        task = build_task(scene, room=(16, 48))
        layout = build_layout(spec.shape(scene.body), jnp.float32)
        period = float(scene.control.period)
        return search.screening.Strokes(task, layout, period, scene.task.steps)

    return build


@pytest.fixture(scope="session")
def chain_stroke():
    """From positions (phase, node, 2) and steps a phase to the stroke of one filament."""

    def build(positions, took):
        from microcosmos.filaments import Rest
        from microcosmos.search.screening.stroke import Stroke, _changes

        shapes = array(positions - positions.mean(1, keepdims=True), jnp.float32)
        changes, turns = jax.jit(_changes)(shapes, array(np.ones(shapes.shape[1])))
        nothing = array(np.zeros((len(shapes), 0)))
        steps = array(np.full(len(shapes), took), jnp.float32)
        return Stroke(Rest(nothing, nothing), shapes, changes, turns, steps)

    return build


@pytest.fixture(scope="session")
def edges():
    """From a number of nodes to the edges of a chain."""
    return lambda nodes: array(np.stack([np.arange(nodes - 1), np.arange(1, nodes)], 1))
