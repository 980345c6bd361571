"""Audits tell swimming by the fluid from artefacts; gradients agree with finite differences."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, neat, spec
from microcosmos.archive import creature
from microcosmos.audit.derivatives import report_gradient
from microcosmos.audit.physics import audit
from microcosmos.audit.variants import reciprocal, refine
from microcosmos.build import build_encoding, build_stroke, build_task, identity_template
from microcosmos.filaments import Rest
from microcosmos.search.parts.records import identity

GAITS = spec.Gaits(period=500, cycles=2)


def audited(form, swimmer, viscosity):
    whole = identity_template(GAITS.scene(form, swimmer, viscosity))
    found = audit(creature.document(whole, None, None))
    return found["verdict"], {row["name"]: row for row in found["rows"]}


@pytest.mark.long
def test_a_worm_that_pushes_on_fluid_is_trusted():
    verdict, rows = audited("ours", "worm", 0.5)
    assert verdict == {"trusted": True, "reasons": []}
    assert 0.9 < rows["refined"]["value"] < 1.3
    assert rows["reciprocal"]["value"] < 0.015
    assert rows["impulse"]["value"] < 1e-4


@pytest.mark.long
def test_a_ray_that_pushes_itself_is_not():
    verdict, rows = audited("paper", "ray", 2.0)
    assert not verdict["trusted"]
    assert rows["impulse"]["passed"] is False
    assert "it pushes itself: this form of the coupling allows it" in verdict["reasons"]


@pytest.mark.parametrize("senses", [pytest.param(False, marks=pytest.mark.long), True])
def test_creatures_with_networks_are_audited_too(senses):
    scene = spec.Scene(
        world=spec.World(width=32, height=32, energy=spec.Energy() if senses else None),
        body=spec.Chain(nodes=12),
        control=spec.Control(period=30, sense_energy=senses),
        task=spec.Task(steps=60),
    )
    inputs = len(scene.control.inputs)
    network = neat.minimal(jax.random.key(0), inputs, 2, 8, 16)
    found = audit(creature.document(identity(identity_template(scene), network), None, None))
    assert {row["name"] for row in found["rows"]} >= {
        "refined",
        "wider limits",
        "no limits",
        "delta",
        "heading",
        "reciprocal",
    }
    assert all(row["value"] is not None for row in found["rows"])


@pytest.mark.fast
def test_a_reciprocal_gait_retraces_its_first_half():
    steps = np.arange(8.0)[:, None]
    back = reciprocal(Rest(jnp.asarray(steps), jnp.asarray(steps)))
    np.testing.assert_array_equal(back.angle[:, 0], [0, 1, 2, 3, 3, 2, 1, 0])


@pytest.mark.fast
def test_refinement_keeps_the_body_the_gait_and_the_dimensionless_numbers():
    scene = GAITS.scene("ours", "cilia", 0.1)
    rest = build_stroke(scene.control, scene.task.steps)
    coarse, (fine, finer) = build_task(scene), refine(scene, rest)
    body = spec.shape(scene.body)
    half = bodies.subdivided(body)
    # The same turns at the same joints, none between; edges of the same length in cells.
    np.testing.assert_array_equal(finer.angle[::4, half.joints], rest.angle)
    straight = np.delete(np.asarray(finer.angle), half.joints, 1)
    assert np.all(straight == 0)
    np.testing.assert_array_equal(finer.length[::4], rest.length[:, half.edges])
    # Twice the cells, four times the steps, half the speeds: the same Reynolds number U L / ν.
    assert fine.world.size == (128, 128)
    assert len(finer.angle) == 4 * len(rest.angle)
    assert fine.length == 2 * coarse.length
    assert fine.world.viscosity == coarse.world.viscosity
    assert fine.world.nu_c == coarse.world.nu_c
    assert 2 * fine.world.limits.force == coarse.world.limits.force
    # Node for node in the same place of the box.
    np.testing.assert_allclose(
        fine.start.positions[half.nodes], 2 * coarse.start.positions, rtol=1e-6
    )


def test_an_audit_that_takes_too_long_is_refused():
    scene = GAITS.scene("ours", "worm", 0.5)
    longer = scene.model_copy(update={"task": spec.Task(steps=1_000_000)})
    with pytest.raises(creature.CreatureError, match=r"task\.steps"):
        audit(creature.document(identity_template(longer), None, None))


SCENE = {
    "world": {"width": 24, "height": 24, "viscosity": 0.1},
    "body": {"nodes": 8},
    "control": {"encoding": "direct", "period": 30, "terms": 1},
    "task": {"steps": 120},
}


@pytest.fixture(scope="module")
def file():
    scene = spec.Scene.model_validate(SCENE)
    encoding = build_encoding(scene, (8, 8))
    newcomer = jax.tree.map(np.asarray, encoding.newcomer(key=jax.random.key(1)))
    return creature.document(identity(identity_template(scene), newcomer), None, None)


@pytest.mark.long
def test_the_report_agrees_with_finite_differences_and_tells_of_time_and_starts(file):
    # Over four periods: in float32 a creature that has hardly moved is mostly rounding.
    report = report_gradient(file, starts=3)
    assert report.errors["float64"] <= 1e-6
    assert report.errors["float32"] <= 1e-2
    assert list(report.norms) == [30, 60, 120]
    assert 0 <= report.sign_agreement <= 1
    assert -1 <= report.cosine <= 1
    assert report.limited == 0
