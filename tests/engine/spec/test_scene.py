"""Scenes: what fits together."""

import pytest
from pydantic import ValidationError

from microcosmos import spec
from microcosmos.spec import Scene


def refusal(**parts):
    with pytest.raises(ValidationError) as caught:
        Scene.model_validate(parts)
    return str(caught.value)


@pytest.mark.fast
@pytest.mark.parametrize(
    ("parts", "said"),
    [
        ({"control": {"sense_energy": True}}, "`world.energy` must be set where `control"),
        ({"task": {"fitness": "energy"}}, "`world.energy` must be set where `task.fitness`"),
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
