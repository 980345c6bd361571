"""Scenes: what fits together, and names of creatures that outlive new fields."""

import pytest
from pydantic import ValidationError

from microcosmos import spec
from microcosmos.archive import creature
from microcosmos.build.creatures import frame
from microcosmos.naming import encode
from microcosmos.spec import Scene, identity

OLD = {
    "format": "microcosmos-creature/1",
    "genome": {
        "encoding": "cppn",
        "inputs": ["position", "sine", "cosine"],
        "outputs": ["rest_angle", "rest_length"],
        "control": {
            "timer": "sine-cosine",
            "position": "signed",
            "period": 50.0,
            "ramp": 1.0,
            "angle_scale": 0.3,
            "length_scale": 0.2,
        },
        "nodes": {
            "id": [0, 1, 2, 3, 4],
            "activation": ["identity"] * 3 + ["sin", "tanh"],
            "bias": encode([0, 0, 0, 0.5, -1]),
        },
        "connections": {
            "innovation": [0, 4],
            "source": [0, 1],
            "target": [3, 4],
            "enabled": [True, True],
            "weight": encode([1, -2]),
        },
    },
    "world": {
        "width": 32,
        "height": 32,
        "viscosity": 0.05,
        "magic": "capped",
        "coupling": {
            "projection": "force+torque",
            "force_factor": 2,
            "theta_feedback": 1,
            "forcing_iterations": 3,
            "constraint_iterations": 10,
            "limits": True,
            "max_displacement": 0.1,
            "max_force": 0.1,
        },
    },
    "body": {
        "builder": "chain",
        "nodes": 16,
        "spacing": 1.0,
        "stretch": 1.0,
        "shear": 1.0,
        "bend": 1.0,
    },
    "task": {"steps": 100, "fitness": "displacement"},
}
"""A creature with all the fields that the first ones had."""


def refusal(**parts):
    with pytest.raises(ValidationError) as caught:
        Scene.model_validate(parts)
    return str(caught.value)


@pytest.mark.fast
def test_a_creature_from_before_later_fields_keeps_its_name():
    file = creature.document(OLD, None, None)
    parsed = creature.parse(file)
    assert parsed["identity"] == OLD
    assert parsed["sha256"] == creature.name(OLD)


def test_the_demonstration_still_makes_creatures_with_the_first_fields():
    made = frame(spec.EXPERIMENTS["quality-diversity"].presets[0].spec.scene)
    assert {k: v for k, v in made.items() if k != "genome"} == {
        k: v for k, v in OLD.items() if k != "genome"
    }
    assert made["genome"]["control"] == OLD["genome"]["control"]


@pytest.mark.fast
@pytest.mark.parametrize(
    ("part", "change"),
    [
        (spec.World, {"steric": spec.Steric()}),
        (spec.World, {"energy": spec.Energy()}),
        (spec.Coupling, {"layers": 2}),
        (spec.Coupling, {"nu_c": 0.1}),
        (spec.Coupling, {"kernel": "roma"}),
        (spec.Control, {"sense_energy": True}),
        (spec.Task, {"energy_weight": 1.0}),
    ],
)
def test_a_later_field_is_named_only_where_it_is_not_the_default(part, change):
    plain, changed = identity(part()), identity(part(**change))
    (name,) = change
    assert name not in plain
    assert name in changed
    assert part.model_validate(plain) == part()
    assert part.model_validate(changed) == part(**change)


@pytest.mark.fast
@pytest.mark.parametrize(
    ("parts", "said"),
    [
        ({"control": {"sense_energy": True}}, "`world.energy` must be there where `control"),
        ({"task": {"fitness": "energy"}}, "`world.energy` must be there where `task.fitness`"),
        (
            {"control": {"swimmer": "ray"}, "body": {"builder": "worm"}},
            "`body.builder` must be 'ray' for its gait, got 'worm'",
        ),
        ({"body": {"nodes": 62}}, "`world.width` must be at least 72 cells"),
        (
            {"body": {"nodes": 62}, "world": {"width": 80}},
            "`world.height` must be at least 72 cells",
        ),
        ({"coupling": {"theta_feedback": 0}}, "`projection` must be 'none' or 'force'"),
    ],
)
def test_parts_that_do_not_fit_are_refused_by_name(parts, said):
    assert said in refusal(**parts)


@pytest.mark.fast
def test_a_gait_needs_only_its_own_body():
    scene = Scene.model_validate({"control": {"swimmer": "ray"}, "body": {"builder": "ray"}})
    assert isinstance(scene.control, spec.Gait)


@pytest.mark.fast
def test_only_forms_without_projection_can_push_themselves():
    forms = {
        name: spec.Coupling(projection=name).force_free for name in ("force", "force+torque")
    }
    assert forms == {"force": True, "force+torque": True}
    assert not spec.Coupling(projection="none").force_free
