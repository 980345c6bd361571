"""Malformed bodies are refused with the reason."""

from dataclasses import fields, replace

import numpy as np
import pytest

from microcosmos import bodies

pytestmark = pytest.mark.fast


def change(name, index, value):
    body = bodies.chain(6, 1.0)
    array = getattr(body, name).copy()
    array[index] = value
    return lambda: replace(body, **{name: array})


def two(**changed):
    pair = bodies.combined([bodies.chain(4, 1.0), bodies.placed(bodies.chain(4, 1.0), (2, 5))])
    return lambda: replace(pair, **changed)


SWAPPED = np.array([[4, 5], [1, 2], [2, 3], [0, 1], [5, 6], [6, 7]])
NO_JOINTS = {"joints": np.zeros((0, 2), int), "rest_angle": np.zeros(0), "bend": np.zeros(0)}

MALFORMED = {
    "an edge to itself": (change("edges", 2, (2, 2)), "different nodes, pair 2 is 2 twice"),
    "an edge twice": (change("edges", 2, (2, 1)), "nodes 1 and 2 twice"),
    "an edge to nowhere": (change("edges", 2, (2, 6)), "nodes 0 to 5, got 6"),
    "an edge from nowhere": (change("edges", 2, (-1, 3)), "nodes 0 to 5, got -1"),
    "an edge of length zero": (change("positions", 3, (2, 0)), "edge 2 has none"),
    "a rest length of zero": (change("rest_length", 1, 0), "`rest_length` must be positive"),
    "a joint with itself": (change("joints", 1, (1, 1)), "different edges, pair 1 is 1 twice"),
    "a joint twice": (change("joints", 1, (1, 0)), "edges 0 and 1 twice"),
    "a joint without its edge": (change("joints", 3, (3, 5)), "edges 0 to 4, got 5"),
    "a joint of edges apart": (change("joints", 1, (1, 3)), "joint 1 joins edges 1 and 3"),
    "nodes too near": (change("positions", 5, (0.1, 0.2)), "nodes 0 and 5 are 0.224 apart"),
    "a place that is not a number": (change("positions", (2, 0), np.nan), "finite, got nan"),
    "an infinite angle": (change("rest_angle", 2, np.inf), "`rest_angle` must be finite"),
    "too stiff": (change("bend", 2, 1.5), "`bend` must be from 0 to 1, got 1.5"),
    "too soft": (change("shear", 0, -0.5), "`shear` must be from 0 to 1, got -0.5"),
    "a node of no creature": (change("member", 5, 2), "`member` must number creatures"),
    "an edge between creatures": (change("member", 5, 1), "edge 4 joins creatures 0 and 1"),
    "edges out of order": (two(edges=SWAPPED, **NO_JOINTS), "order of their creatures"),
    "edges that are fractions": (two(edges=SWAPPED + 0.0), "whole numbers, got float64"),
    "a drawn edge to itself": (
        lambda: bodies.graph([(0, 0), (1, 0), (2, 0)], [(0, 1), (1, 2), (2, 2)]),
        "`edges` must be pairs of different nodes, pair 2 is 2 twice",
    ),
    "two drawn nodes in one place": (
        lambda: bodies.graph([(0, 0), (1, 0), (1, 0)], [(0, 1), (1, 2)]),
        "`edges` must have a length, edge 1 has none",
    ),
    "no edges": (
        lambda: bodies.graph([(0, 0), (1, 0)], []),
        "at least two nodes and one edge, got 2 and 0",
    ),
}


@pytest.mark.parametrize("name", MALFORMED)
def test_a_malformed_body_is_refused_with_the_reason(name):
    build, reason = MALFORMED[name]
    with pytest.raises(ValueError, match=reason):
        build()


@pytest.mark.parametrize(
    "name", [field.name for field in fields(bodies.Body) if field.name != "crossing"]
)
def test_an_array_of_the_wrong_length_is_refused(name):
    body = bodies.chain(6, 1.0)
    longer = np.concatenate([getattr(body, name), getattr(body, name)[-1:]])
    with pytest.raises(ValueError, match="must be "):
        replace(body, **{name: longer})


@pytest.mark.parametrize("seed", range(20))
def test_crowding_is_found_exactly_where_it_is(seed):
    random = np.random.default_rng(seed)
    nodes = random.uniform(0, 4, (12, 2))
    gaps = np.hypot(*(nodes[:, None] - nodes[None]).transpose(2, 0, 1))
    nearest = gaps[np.triu_indices(12, 1)].min()
    edges = [(i, i + 1) for i in range(11)]
    bodies.graph(0.251 / nearest * nodes, edges)
    with pytest.raises(ValueError, match=r"0\.249 apart"):
        bodies.graph(0.249 / nearest * nodes, edges)
