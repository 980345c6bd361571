"""Grown bodies in a fluid: momentum, lengths and soft joints."""

from functools import cache

import body_plans
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from genotypes import any_network, padded

from microcosmos import filaments, fluid, genomes, spec, units, world
from microcosmos.build import build_task
from microcosmos.device import array
from microcosmos.neat import plans
from microcosmos.search.simulation import drive

ROOM = (40, 120)
STEPS = 100
PLANS = 20
BODY = spec.GrownBody(
    builder="grown", nodes=24, length=18.0, segments=6, segment_nodes=16, rings=2
)


def task_of(softest=1.0, *, limits=True, **box):
    control = spec.BodyGraph(length_scale=0.0, period=40.0, softest=softest, max_speed=None)
    scene = spec.Scene(
        world=spec.World(**{"width": 40, "height": 40} | box),
        coupling=spec.Coupling(limits=limits),
        body=BODY,
        control=control,
        task=spec.Task(steps=STEPS),
    )
    return build_task(scene, room=ROOM), control


@pytest.fixture(scope="module")
def population():
    """Plans that have mutated, those with rings among them."""
    rates = plans.PlanRates(BODY.genes, structure=0.7, values=0.4, vary=0.9)
    keys = jax.random.split(jax.random.key(1), PLANS)
    return jax.jit(jax.vmap(lambda key: body_plans.mutated(key, 8, rates)))(keys)


def test_a_grown_body_begins_in_the_middle_however_few_nodes_it_has(population):
    task, control = task_of()
    network = padded(any_network(control, np.random.default_rng(0)), ROOM)

    @jax.jit
    def begun(plan):
        driven = drive(task, genomes.BodyGraph(plan, network), differentiable=True)
        return driven.world.present, driven.start.positions

    counts = set()
    for index in range(PLANS):
        present, positions = begun(body_plans.member(population, index))
        counts.add(int(present.sum()))
        np.testing.assert_allclose(positions[present].mean(0), (20, 20), atol=1e-4)
    assert min(counts) < BODY.nodes, "no body lacks a node"


@pytest.fixture(scope="module")
def swum(population):
    """A function that simulates all plans with random networks."""

    @cache
    def swim(softest, limits):
        task, control = task_of(softest, limits=limits)
        random = np.random.default_rng(0)

        @jax.jit
        def run(genotype):
            driven = drive(task, genotype, differentiable=True)
            given = driven.world, driven.start, driven.inputs

            def observe(state, measures):
                momentum = fluid.momentum(state.populations)
                return measures, jnp.stack([jnp.sum(one) for one in momentum])

            _, found = world.rollout(*given, observe)
            return _arrays(driven, *found)

        networks = [padded(any_network(control, random), ROOM) for _ in range(PLANS)]
        genotypes = [
            genomes.BodyGraph(body_plans.member(population, index), network)
            for index, network in enumerate(networks)
        ]
        return [jax.device_get(run(one)) for one in genotypes]

    return swim


@pytest.mark.long
@pytest.mark.parametrize("softest", [1.0, 0.1])
def test_grown_bodies_give_the_fluid_no_impulse(swum, softest):
    impulses = [np.hypot(*momentum.T).max() for *_, momentum in swum(softest, True)]
    assert max(impulses) <= units.MAX_IMPULSE
    assert max(impulses) > 0


@pytest.mark.long
def test_edges_keep_their_rest_length(swum):
    """But for those of bent rings, whose joints disagree: least squares gives these."""
    rings = 0
    for boned, rest, measures, _ in swum(1.0, False):
        edges, there, shapes = boned
        length, fitted = (_lengths(one, edges) for one in (measures.positions, shapes))
        closed = there[BODY.nodes :].any()
        rings += closed
        assert np.abs(length - fitted)[:, there].max() < 2e-4
        if not closed:
            assert np.abs(length - rest.length)[:, there].max() < 2e-4
    assert 0 < rings < PLANS


ROOTS = {
    "a chain": ({"nodes": 9},),
    "a star": ({"nodes": 5}, {"nodes": 5, "copies": 3}),
    "a limb": ({"nodes": 9}, {"nodes": 5, "place": 0.5, "angle": 1.5}),
}


@pytest.mark.long
@pytest.mark.parametrize("native", [False, True])
@pytest.mark.parametrize("root", ROOTS)
def test_soft_joints_relax_exponentially(root, native):
    """In a world without fluid the error is (1 − k)ᵗ of the first, k being the stiffness."""
    if native:
        pytest.importorskip("microcosmos_kernels")
    softest, stiffness, turn = 0.1, 0.4, 0.3
    task, control = task_of(softest, limits=False, fluid=False)
    plan = body_plans.plan_of(
        *({"stiffness": stiffness} | one for one in ROOTS[root]), rows=BODY.segments
    )
    network = padded(any_network(control, np.random.default_rng(0)), ROOM)
    genotype = genomes.BodyGraph(body_plans.to_jax(plan), network)
    box, start, first = developed(task, genotype)
    layout, joints = box.layout, np.asarray(box.rods.joints)
    tip = np.asarray(box.rods.bend) > 0
    # A joint that is bent alone: the second to last of the root.
    bent = int(np.flatnonzero(tip)[1])
    angle = np.tile(np.asarray(layout.rest_angle), (40, 1))
    angle[:, bent] += np.float32(turn)
    rest = filaments.Rest(array(angle), array(np.repeat(np.asarray(first.length), 40, 0)))
    way = world.native.rollout if native else _observed
    measures = jax.jit(way)(box, start, rest)[1]
    ends = np.asarray(measures.positions)[:, np.asarray(box.rods.edges)]
    v = ends[:, :, 1] - ends[:, :, 0]
    angle = np.arctan2(v[..., 1], v[..., 0])
    angles = angle[:, joints[:, 1]] - angle[:, joints[:, 0]] - np.asarray(layout.rest_angle)
    error = turn - (angles - 2 * np.pi * np.round(angles / (2 * np.pi)))[:, bent]
    rate = softest ** (1 - stiffness)
    expected = turn * (1 - rate) ** np.arange(1, 41)
    np.testing.assert_allclose(error, expected, atol=2e-5)


def developed(task, genotype):
    """The world and the start of a creature, and its rest shape at first, from one program."""

    @jax.jit
    def develop(genotype):
        driven = drive(task, genotype, differentiable=True)
        return driven.world, driven.start, jax.tree.map(lambda x: x[:1], driven.inputs)

    return develop(genotype)


def _observed(box, start, rest):
    return world.rollout(box, start, rest, lambda state, measures: measures)


def _arrays(driven, measures, momentum):
    rods, rest = driven.world.rods, driven.inputs
    shapes = filaments.rest_positions(rest, driven.world.layout)
    return (rods.edges, rods.stretch > 0, shapes), rest, measures, momentum


def _lengths(positions, edges):
    ends = positions[:, edges]
    return np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=-1)
