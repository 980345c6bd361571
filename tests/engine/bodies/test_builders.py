"""Builders of bodies, compared with closed forms."""

import numpy as np
import pytest

from microcosmos import bodies
from microcosmos.bodies.resolution import subdivided

pytestmark = pytest.mark.fast

STIFF = {"stretch": 0.7, "shear": 0.8, "bend": 0.9}
FORK = [(0, 0), (1, 0), (2, 1), (2, -1)]

BUILT = {
    "chain": lambda **k: bodies.chain(9, 0.5, **k),
    "ring": lambda **k: bodies.ring(13, 1.0, **k),
    "arc": lambda **k: bodies.arc(12, 1.0, 0.25, **k),
    "star": lambda **k: bodies.star(5, 4, 1.0, **k),
    "tree": lambda **k: bodies.tree(3, 2, 5, 1.0, 0.9, **k),
    "polyline": lambda **k: bodies.polyline([(0, 0), (9, 0), (9, 7)], 1.0, **k),
    "loop": lambda **k: bodies.polyline([(0, 0), (9, 0), (9, 7)], 1.0, closed=True, **k),
    "svg": lambda **k: bodies.svg("M 0 0 C 5 0 5 9 12 9", 1.0, **k),
    "graph": lambda **k: bodies.graph(FORK, [(0, 1), (2, 1), (1, 3)], **k),
}


def geometry(body):
    """Lengths of edges, and angles between the edges of joints within ±π."""
    v = body.positions[body.edges[:, 1]] - body.positions[body.edges[:, 0]]
    heading = v[:, 0] + 1j * v[:, 1]
    return np.abs(heading), np.angle(heading[body.joints[:, 1]] / heading[body.joints[:, 0]])


@pytest.mark.parametrize("name", BUILT)
def test_a_body_is_at_rest_as_it_is_built(name):
    body = BUILT[name](**STIFF)
    length, angle = geometry(body)
    np.testing.assert_allclose(body.rest_length, length, rtol=1e-12)
    np.testing.assert_allclose(np.exp(1j * body.rest_angle), np.exp(1j * angle), atol=1e-12)
    assert np.all(np.abs(body.rest_angle) <= np.pi)
    for field, value in STIFF.items():
        np.testing.assert_array_equal(getattr(body, field), value)
    assert (body.arc.min(), body.count) == (0, 1)
    assert body.arc.max() <= 1


@pytest.mark.parametrize("name", BUILT)
def test_edges_of_a_joint_share_its_node_and_a_branch_has_a_joint_for_each_edge(name):
    body = BUILT[name]()
    for joint, node in zip(body.joints, body.joint_nodes, strict=True):
        first, second = body.edges[joint]
        assert set(first) & set(second) == {node}
    degree = np.bincount(body.edges.reshape(-1))
    joints = np.bincount(body.joint_nodes, minlength=len(degree))
    np.testing.assert_array_equal(joints, np.where(degree > 2, degree, degree - 1))


@pytest.mark.parametrize("nodes", [3, 8, 40])
def test_a_ring_is_a_regular_polygon_that_turns_once(nodes):
    body = bodies.ring(nodes, 1.5)
    length, _ = geometry(body)
    np.testing.assert_allclose(length, 1.5, rtol=1e-12)
    np.testing.assert_allclose(body.rest_angle, 2 * np.pi / nodes, rtol=1e-12)
    np.testing.assert_allclose(np.ptp(np.hypot(*body.positions.T)), 0, atol=1e-12)
    np.testing.assert_allclose(body.arc, np.arange(nodes) / nodes)


@pytest.mark.parametrize("gap", [0.05, 0.25, 0.9])
def test_an_arc_leaves_its_share_of_the_circle_open(gap):
    nodes, radius = 32, 0.5 / np.sin(np.pi * (1 - gap) / 31)
    body = bodies.arc(nodes, 1.0, gap)
    length, _ = geometry(body)
    np.testing.assert_allclose(length, 1.0, rtol=1e-12)
    np.testing.assert_allclose(np.sum(body.rest_angle) * 31 / 30, 2 * np.pi * (1 - gap))
    opening = np.hypot(*(body.positions[-1] - body.positions[0]))
    np.testing.assert_allclose(opening, 2 * radius * np.sin(np.pi * gap), rtol=1e-10)
    assert (body.arc[0], body.arc[-1]) == (0, 1)


def test_a_star_has_equal_straight_arms_evenly_around():
    body = bodies.star(6, 7, 1.5)
    assert len(body.positions) == 1 + 6 * 7
    tips = body.positions[body.arc > 1 - 1e-9]
    np.testing.assert_allclose(np.hypot(*tips.T), 7 * 1.5)
    heading = np.sort(np.angle(tips @ [1, 1j]) % (2 * np.pi))
    np.testing.assert_allclose(heading, np.arange(6) * np.pi / 3, atol=1e-9)
    np.testing.assert_allclose(body.rest_angle[body.joint_nodes > 0], 0, atol=1e-12)
    np.testing.assert_allclose(np.abs(body.rest_angle[body.joint_nodes == 0]), np.pi / 3)


@pytest.mark.parametrize(("levels", "branches"), [(1, 3), (3, 2), (2, 4)])
def test_a_tree_forks_at_every_level_over_its_angle(levels, branches):
    body = bodies.tree(levels, branches, 5, 1.0, 1.2)
    segments = sum(branches**level for level in range(levels))
    assert len(body.positions) == 1 + 5 * segments
    degree = np.bincount(body.edges.reshape(-1))
    assert np.sum(degree == branches + 1) == sum(branches**level for level in range(levels - 1))
    assert np.sum(degree == 1) == 1 + branches ** (levels - 1)
    np.testing.assert_allclose(np.sum(body.arc > 1 - 1e-9), branches ** (levels - 1))
    if levels > 1:
        leaving = body.positions[np.flatnonzero(body.edges[:, 0] == 5) + 1] - body.positions[5]
        heading = np.angle(leaving @ [1, 1j])
        np.testing.assert_allclose(np.sort(heading), np.linspace(-0.6, 0.6, branches))


def test_a_polyline_is_resampled_at_equal_arc_length():
    body = bodies.polyline([(0, 0), (6.1, 0), (6.1, 0), (20.3, 0)], 1.0)
    np.testing.assert_allclose(body.rest_length, 20.3 / 20, rtol=1e-12)
    np.testing.assert_allclose(body.positions[[0, -1]], [(0, 0), (20.3, 0)], atol=1e-12)
    np.testing.assert_allclose(body.arc, np.arange(21) / 20)


def test_a_circle_drawn_as_a_polyline_or_as_a_path_is_a_ring():
    path = "M 10 0 A 10 10 0 0 1 -10 0 A 10 10 0 0 1 10 0 Z"
    turn = 2 * np.pi * np.arange(4000) / 4000
    circle = 10.0 * np.stack([np.cos(turn), np.sin(turn)], 1)
    drawn = bodies.polyline(circle, 1.0, closed=True)
    written = bodies.svg(path, 1.0)
    whole = bodies.svg('<svg xmlns="http://www.w3.org/2000/svg"><circle r="10"/></svg>', 1.0)
    for body in (drawn, written, whole):
        assert len(body.edges) == len(body.positions) == 63
        np.testing.assert_allclose(body.rest_length, 20 * np.sin(np.pi / 63), rtol=1e-4)
        np.testing.assert_allclose(np.abs(body.rest_angle), 2 * np.pi / 63, rtol=2e-3)
        np.testing.assert_allclose(np.abs(np.sum(body.rest_angle)), 2 * np.pi, rtol=1e-12)
        np.testing.assert_allclose(np.hypot(*body.positions.T), 10, rtol=1e-4)


def test_strands_of_an_svg_are_joined_where_they_end_and_drawn_upright():
    body = bodies.svg("M 0 0 L 10 0 M 10.2 0 L 20 5 M 10 0.1 L 20 -5 M 5 0.1 V 8", 1.0)
    degree = np.bincount(body.edges.reshape(-1))
    assert np.sum(degree == 3) == 2
    assert np.sum(degree == 1) == 4
    assert body.positions[:, 1].min() == -8
    np.testing.assert_allclose(body.rest_length, 1, atol=0.5)


def test_a_document_is_drawn_with_its_transforms():
    path = '<g transform="translate(30,-4)"><path d="M 0 0 H 8"/></g>'
    body = bodies.svg(f'<svg xmlns="http://www.w3.org/2000/svg">{path}</svg>', 1.0)
    np.testing.assert_allclose(body.positions, np.stack([30 + np.arange(9), np.full(9, 4)], 1))


def test_a_networkx_graph_becomes_its_body():
    networkx = pytest.importorskip("networkx")
    graph = networkx.Graph()
    for name, place in {"a": (0, 0), "b": (3, 0), "c": (3, 4)}.items():
        graph.add_node(name, pos=place)
    graph.add_edge("a", "b", rest_length=2.5, stretch=0.5)
    graph.add_edge("b", "c")
    body = bodies.from_graph(graph, shear=0.4)
    np.testing.assert_array_equal(body.positions, [(0, 0), (3, 0), (3, 4)])
    np.testing.assert_array_equal(body.rest_length, [2.5, 4])
    np.testing.assert_array_equal(body.stretch, [0.5, 1])
    np.testing.assert_array_equal(body.shear, 0.4)
    np.testing.assert_allclose(body.rest_angle, [np.pi / 2])
    graph.add_node("d")
    message = "`pos` must be two numbers at each node, got None at 'd'"
    with pytest.raises(ValueError, match=message):
        bodies.from_graph(graph)


@pytest.mark.parametrize(
    ("build", "reason"),
    [
        (lambda: bodies.chain(1, 1.0), "`nodes` must be at least 2"),
        (lambda: bodies.ring(2, 1.0), "`nodes` must be at least 3"),
        (lambda: bodies.arc(9, 1.0, 1.0), "`gap` must be between 0 and 1"),
        (lambda: bodies.star(0, 4, 1.0), "`arms` must be at least 1"),
        (lambda: bodies.tree(2, 0, 4, 1.0, 0.5), "`branches` must be at least 1"),
        (lambda: bodies.polyline([(0, 0)], 1.0), "`points` must be at least two"),
        (lambda: bodies.polyline([(0, 0), (9, 0)], 0.0), "`spacing` must be positive"),
        (lambda: bodies.polyline([(1, 1), (1, 1)], 1.0), "must not all be the same"),
        (lambda: bodies.polyline([(0, 0), (9, 0), (0, 0.1)], 1.0), "cells apart"),
        (lambda: bodies.combined([]), "at least one body"),
        (lambda: bodies.graph(np.array(FORK).T, [(0, 1)]), r"`nodes` must be rows \(x, y\)"),
        (lambda: bodies.graph(np.array(FORK) + 1j, [(0, 1)]), "`nodes` must be .* complex128"),
        (lambda: bodies.graph(FORK, [(0, 2, 1), (1, 1, 3)]), "`edges` must be pairs"),
        (lambda: bodies.graph(FORK, [(0.7, 1), (2, 1), (1, 3)]), "`edges` .* float64"),
        (lambda: bodies.graph(FORK, [(0, 1), (2, 1)]), "must join every node; node 3 is in"),
    ],
)
def test_measures_that_make_no_body_are_refused(build, reason):
    with pytest.raises(ValueError, match=reason):
        build()


def test_nodes_are_evenly_spaced_and_joints_turn_as_they_were_drawn():
    body = bodies.walk(5000, 0.4, 0.3, 1)
    steps = np.diff(body.positions, axis=0)
    np.testing.assert_allclose(np.hypot(*steps.T), 0.4)
    angle = np.arctan2(steps[:, 1], steps[:, 0])
    turns = (np.diff(angle) + np.pi) % (2 * np.pi) - np.pi
    np.testing.assert_allclose(turns, body.rest_angle, atol=1e-9)
    assert abs(body.rest_angle.std() - 0.3) < 0.01
    assert abs(body.rest_angle.mean()) < 0.02


def test_the_mean_square_distance_of_ends_is_that_of_a_freely_rotating_chain():
    # Flory: <R²> = n l² [(1 + c)/(1 − c) − 2 c (1 − cⁿ)/(n (1 − c)²)], c = <cos turn>.
    n, c = 99, np.exp(-(0.5**2) / 2)
    ends = [bodies.walk(n + 1, 1.0, 0.5, seed).positions for seed in range(2000)]
    found = np.mean([np.sum((p[-1] - p[0]) ** 2) for p in ends])
    expected = n * ((1 + c) / (1 - c) - 2 * c * (1 - c**n) / (n * (1 - c) ** 2))
    assert abs(found / expected - 1) < 0.06


def test_a_walk_may_cross_itself_and_other_bodies_may_not():
    body = bodies.walk(300, 0.4, 1.0, 0)
    assert body.crossing
    assert bodies.combined([body, body]).crossing
    assert len(subdivided(body).body.positions) == 599
    with pytest.raises(ValueError, match="cells apart"):
        bodies.polyline([(0, 0), (4, 0), (2, 0.01)], 0.5)
