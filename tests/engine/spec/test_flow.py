"""Flows of a spec: refusal of what cannot be."""

import pytest
from pydantic import ValidationError

from microcosmos import spec

pytestmark = pytest.mark.fast


@pytest.mark.parametrize(
    ("world", "message"),
    [
        ({"flow": {"speed": 0.06}}, "less than or equal to 0.05"),
        ({"flow": {"kind": "vortices", "vortices": 3}}, "multiple of 2"),
        (
            {"flow": {"kind": "vortices", "vortices": 48}},
            "`flow.vortices` must be at most 6 in 48 × 48 cells, 8 cells for each; got 48",
        ),
        (
            {"flow": {"kind": "vortices", "vortices": 4}, "width": 128, "height": 30},
            "`flow.vortices` must be at most 2 in 128 × 30 cells",
        ),
        ({"flow": {}, "fluid": False}, "`flow` must be empty where `fluid` is false"),
    ],
)
def test_impossible_flows_are_refused(world, message):
    with pytest.raises(ValidationError, match=message):
        spec.World.model_validate(world)


@pytest.mark.parametrize(
    ("fitness", "world", "message"),
    [
        ("upstream", {}, "`world.flow` must be 'poiseuille'.*got none"),
        (
            "upstream",
            {"flow": {"kind": "vortices"}},
            "`world.flow` must be 'poiseuille'.*vortices",
        ),
        ("through", {"flow": {}}, "`world.obstacles` must hold some.*got none"),
        *(
            # Of 200 columns in 48 cells the second is under no middle of a cell.
            ("through", {"obstacles": [{"kind": "pattern", "rows": rows}]}, "have a solid cell")
            for rows in (".", ".#" + 198 * ".")
        ),
    ],
)
def test_tasks_need_the_world_that_they_are_about(fitness, world, message):
    with pytest.raises(ValidationError, match=message):
        spec.Scene.model_validate({"world": world, "task": {"fitness": fitness}})


@pytest.mark.parametrize("fitness", ["speed", "upstream", "through"])
def test_tasks_over_strokes_need_a_periodic_timer(fitness):
    world = {"flow": {}, "obstacles": [{"kind": "post", "x": 8, "y": 8}]}
    control = {"timer": "linear"}
    with pytest.raises(ValidationError, match=f"must not be {fitness!r}"):
        spec.Scene.model_validate(
            {"world": world, "control": control, "task": {"fitness": fitness}}
        )
