"""Projection of many equal bodies, a chunk of them at a time."""

from dataclasses import replace
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, filaments
from microcosmos.build import build_rods
from microcosmos.filaments import chunks

ITERATIONS = 10


@pytest.fixture(params=["chain", "star"])
def crowd(request, monkeypatch):
    one = bodies.chain(9, 1.0) if request.param == "chain" else bodies.star(3, 3, 1.0)
    monkeypatch.setattr(chunks, "CHUNK", 3 * len(one.positions) + 1)
    return bodies.combined([bodies.placed(one, (20.0 * i, 0.0)) for i in range(7)])


def all_at_once(body, rods):
    def pairings(colours):
        parts = [(c.partner, c.constraint, c.sign) for c in colours]
        return tuple(filaments.Pairing(*map(jnp.asarray, part)) for part in parts)

    edges, joints = pairings(body.edge_colours), pairings(body.joint_colours)
    return replace(rods, edge_colours=edges, joint_colours=joints)


def disturbed(body):
    """Nodes and angles off their rest, and stiffnesses and rest shapes of their own."""
    random = np.random.default_rng(3)
    rods = build_rods(body, jnp.dtype("float64"))
    positions = jnp.asarray(body.positions + 0.2 * random.normal(size=body.positions.shape))
    sizes = {"stretch": len(body.edges), "shear": len(body.edges), "bend": len(body.joints)}
    stiffness = {k: jnp.asarray(random.uniform(0.5, 1, size)) for k, size in sizes.items()}
    soft = replace(rods, **stiffness)
    rest = filaments.Rest(
        jnp.asarray(body.rest_angle + random.uniform(-0.3, 0.3, len(body.joints))),
        jnp.asarray(body.rest_length * random.uniform(0.8, 1.2, len(body.edges))),
    )
    return positions, jax.jit(filaments.edge_angles)(positions, soft), soft, rest


def test_equal_bodies_share_the_colours_of_the_first_chunk(crowd):
    rods = build_rods(crowd)
    nodes, edges = len(crowd.positions) // 7, len(crowd.edges) // 7
    assert {len(colour.partner) for colour in rods.edge_colours} == {3 * nodes}
    assert {len(colour.partner) for colour in rods.joint_colours} == {3 * edges}


def test_bodies_that_differ_in_nodes_or_in_edges_are_one_chunk(crowd):
    other = bodies.placed(bodies.chain(8, 1.0), (150.0, 0.0))
    mixed = bodies.combined([crowd, other])
    found = filaments.first_chunk(mixed.member, mixed.edges, mixed.joints)
    assert found == (len(mixed.positions), len(mixed.edges))
    edges = crowd.edges.copy()
    edges[-1] = edges[-1, ::-1]
    found = filaments.first_chunk(crowd.member, edges, crowd.joints)
    assert found == (len(crowd.positions), len(crowd.edges))


def test_chunks_equal_all_bodies_at_once_and_displacements_of_each_sum_to_zero(float64, crowd):
    positions, angles, rods, rest = disturbed(crowd)
    project = jax.jit(filaments.project, static_argnames="iterations")
    found = project(positions, angles, rods, rest, iterations=ITERATIONS)
    whole = all_at_once(crowd, rods)
    expected = project(positions, angles, whole, rest, iterations=ITERATIONS)
    for by_chunks, plain in zip(found, expected, strict=True):
        np.testing.assert_allclose(by_chunks, plain, rtol=0, atol=1e-13)
    moved = np.asarray(found[0]) - positions
    assert np.abs(moved).max() > 0.1
    of_body = moved.reshape(7, -1, 2).sum(1)
    np.testing.assert_allclose(of_body, 0, atol=1e-13)


@pytest.mark.long
def test_chunks_have_the_gradient_of_all_bodies_at_once(float64, crowd):
    positions, angles, rods, rest = disturbed(crowd)
    stiffness = (rods.stretch, rods.shear, rods.bend)

    def slope(rods):
        def total(positions, angles, rest, stiffness):
            stretch, shear, bend = stiffness
            own = replace(rods, stretch=stretch, shear=shear, bend=bend)
            x, theta = filaments.project(positions, angles, own, rest, iterations=3)
            return jnp.sum(jnp.sin(x)) + jnp.sum(theta**2)

        return jax.jit(jax.grad(total, (0, 1, 2, 3)))(positions, angles, rest, stiffness)

    near = partial(np.testing.assert_allclose, rtol=0, atol=1e-12)
    jax.tree.map(near, slope(rods), slope(all_at_once(crowd, rods)))
