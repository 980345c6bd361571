"""Filaments that cross in recorded poses."""

import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos.archive.poses import FRAMES
from microcosmos.search import Poses, crossing
from microcosmos.search.window import Window, poses

pytestmark = pytest.mark.fast

CHAIN = np.array([[0, 1], [1, 2], [2, 3]])
OPEN = np.array([[0, 0], [4, 0], [4, 3], [6, 5]], float)
CROSSED = np.array([[0, 0], [4, 0], [4, 3], [1, -2]], float)
TOUCHING = np.array([[0, 0], [4, 0], [4, 3], [2, 0]], float)


def recorded(shapes, edges=CHAIN, present=None) -> Poses:
    """Shapes, each of which is recorded equally often."""
    positions = jnp.asarray(np.repeat(shapes, FRAMES // len(shapes), 0), jnp.float32)
    there = np.ones(positions.shape[1], bool) if present is None else np.asarray(present)
    begin, end = jnp.asarray(0), jnp.asarray(FRAMES)
    whole = Window(start=begin, stop=end, strokes=jnp.asarray(2))
    centre = positions.mean(1)
    path, graph = (
        jnp.concatenate([centre[:1], centre]),
        (jnp.asarray(there), jnp.asarray(edges)),
    )
    return poses(path, positions[whole.places()], jnp.zeros((FRAMES, 2)), *graph, whole, 1.0)


def share(shapes, start=OPEN, **options):
    return float(crossing(recorded(shapes, **options), jnp.asarray(start, jnp.float32)))


@pytest.mark.long
def test_the_share_of_poses_in_which_edges_cross_counts():
    assert share([OPEN]) == 0
    assert share([CROSSED]) == 1
    assert share([OPEN, OPEN, CROSSED, OPEN]) == 0.25


def test_edges_that_touch_or_share_a_node_do_not_cross():
    assert share([TOUCHING]) == 0
    folded = np.array([[0, 0], [4, 0], [1, 1], [3, -1]], float)
    assert share([folded], edges=np.array([[0, 1], [1, 2], [1, 3]])) == 0


def test_what_crosses_at_the_start_may_cross():
    assert share([CROSSED], start=CROSSED) == 0


def test_nodes_that_have_not_grown_cross_nothing():
    assert share([CROSSED], present=[True, True, True, False]) == 0


@pytest.mark.long
def test_random_filaments_cross_where_their_segments_do():
    rng = np.random.default_rng(0)
    shapes = rng.uniform(-20, 20, (FRAMES, 4, 2))

    def cross(a, b, c, d):
        """Solve for the place on each segment."""
        s, t = np.linalg.solve(np.stack([b - a, c - d], 1), c - a)
        return 0 < s < 1 and 0 < t < 1

    apart = np.array([[0, 1], [2, 3]])
    expected = np.mean([cross(*shape) for shape in shapes])
    assert 0.1 < expected < 0.5
    assert share(shapes, edges=apart) == expected
