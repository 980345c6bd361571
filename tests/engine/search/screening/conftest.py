"""A scene of chains whose shape is written by hand, and its strokes."""

import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import search, spec
from microcosmos.build.scene import build_layout, build_task

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

        shapes = jnp.asarray(positions - positions.mean(1, keepdims=True), jnp.float32)
        changes, turns = _changes(shapes, jnp.ones(shapes.shape[1]))
        nothing = jnp.zeros((len(shapes), 0))
        steps = jnp.full(len(shapes), took, jnp.float32)
        return Stroke(Rest(nothing, nothing), shapes, changes, turns, steps)

    return build


@pytest.fixture(scope="session")
def edges():
    """From a number of nodes to the edges of a chain."""
    return lambda nodes: jnp.asarray(np.stack([np.arange(nodes - 1), np.arange(1, nodes)], 1))
