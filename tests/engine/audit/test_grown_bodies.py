"""A body that a plan grew is built again with the same joints, stiffness and rest shapes."""

from functools import cache

import jax
import numpy as np
import pytest
from grown_bodies import ROOM, genotype_of, grown_file, grown_scene

from microcosmos import bodies, search
from microcosmos.audit.physics import audit
from microcosmos.audit.variants import at_full_strength, body_of, refine, with_limits
from microcosmos.build import build_task
from microcosmos.device import array
from microcosmos.filaments import Rest
from microcosmos.genomes import Drive
from microcosmos.world import route

SOFT = 0.05


@cache
def rebuilt(softest):
    """Simulate the creature: its scene, drive and path, the body built again, its rest."""
    scene = grown_scene(softest=softest)
    task = build_task(scene, room=ROOM)

    @jax.jit
    def swim(genotype):
        driven = search.drive(task, genotype)
        given = driven.world, driven.start, driven.inputs
        seen = search.simulate(driven)[1]
        return given, driven.layout, seen, route(driven.world, driven.start, seen).places

    given, layout, seen, places = swim(genotype_of(scene))
    driven = Drive(*given, layout=layout)
    body, joints, edges = body_of(scene, driven)
    angle, length = np.asarray(seen.rest.angle), np.asarray(seen.rest.length)
    rest = Rest(array(angle[:, joints]), array(length[:, edges]))
    return scene, driven, np.asarray(places), body, rest


@pytest.mark.long
@pytest.mark.parametrize("softest", [1.0, SOFT])
def test_a_grown_body_that_is_built_again_moves_as_before(softest):
    scene, _, centre, body, rest = rebuilt(softest)
    assert len(body.positions) == 26
    # A tree has an edge less than nodes, a joint less than edges; a ring one and two more.
    assert (len(body.edges), len(body.joints)) == (26, 26)
    task = with_limits(scene, body, 1.0)
    layout = task.world.layout
    assert layout is not None
    assert (layout.bend is None) == (softest == 1)
    _, seen = search.simulate(search.drive(task, rest))
    moved = np.abs(centre - centre[0]).max()
    found = route(task.world, task.start, seen).places
    np.testing.assert_allclose(found, centre, atol=1e-2 * moved)


def test_soft_joints_and_repulsion_act_in_the_same_time_on_a_finer_grid():
    scene, driven, _, body, rest = rebuilt(SOFT)
    fine = refine(scene, rest, body)[0].world
    assert fine.layout is not None
    assert fine.layout.bend is not None
    half = bodies.subdivided(body)
    # An error e that grows by a load l in each step, to (1 − b)(e + l), settles at
    # (1 − b) / b of it; the loads of the shorter steps are a quarter.
    stiff = np.asarray(fine.layout.bend, float)[half.joints]
    np.testing.assert_allclose((1 - stiff) / stiff / 4, (1 - body.bend) / body.bend, rtol=1e-4)
    between = np.delete(np.asarray(fine.layout.bend), half.joints)
    assert 0 < between.min() < 0.5
    now, then = driven.world.steric, fine.steric
    assert now is not None
    assert then is not None
    assert (2 * then.strength, 2 * then.limit) == (now.strength, now.limit)


def test_a_reciprocal_gait_is_simulated_with_stiff_joints():
    scene, _, _, body, _ = rebuilt(SOFT)
    layout = at_full_strength(scene, body).world.layout
    assert layout is not None
    assert layout.bend is None


@pytest.mark.long
@pytest.mark.parametrize("softest", [1.0, SOFT])
def test_every_row_of_an_audit_has_a_value_for_a_branched_body_with_a_ring(softest):
    rows = {row["name"]: row for row in audit(grown_file(grown_scene(softest=softest)))["rows"]}
    assert all(row["value"] is not None for row in rows.values())
    for name in ("wider limits", "no limits"):
        assert rows[name]["value"] == pytest.approx(1, abs=0.05)
