"""Obstacles of a spec: their cells, and refusal of what does not fit."""

import numpy as np
import pytest
from pydantic import ValidationError

from microcosmos import spec

pytestmark = pytest.mark.fast


def cells(*obstacles, size=(24, 16)):
    width, height = size
    return spec.World(width=width, height=height, obstacles=obstacles).solid


def test_a_post_holds_the_cells_whose_middles_it_covers_also_across_the_edges():
    solid = cells(spec.Post(x=0, y=15, radius=2))
    x, y = np.meshgrid(np.arange(24), np.arange(16), indexing="ij")
    x, y = np.minimum(x, 24 - x), np.minimum(abs(y - 15), 16 - abs(y - 15))
    np.testing.assert_array_equal(solid, np.hypot(x, y) <= 2)


def test_a_wall_along_the_box_fills_its_thickness():
    solid = cells(spec.Wall(kind="wall", x0=0, y0=4, x1=24, y1=4, thickness=3))
    np.testing.assert_array_equal(solid.any(0), np.isin(np.arange(16), (3, 4, 5)))
    assert solid[:, 3:6].all()


def test_a_pattern_is_stretched_to_the_box_with_its_first_row_on_top():
    solid = cells(spec.Pattern(kind="pattern", rows="#../..."))
    expected = np.zeros((24, 16), bool)
    expected[:8, 8:] = True
    np.testing.assert_array_equal(solid, expected)


def test_the_ink_of_a_picture_becomes_a_pattern():
    assert spec.Pattern.of_ink(np.array([[0, 1, 0.4], [0.6, 1, 0]])).rows == ".#./##."


@pytest.mark.parametrize(
    ("obstacle", "message"),
    [
        ({"kind": "pattern", "rows": "#./..."}, "`rows` must have one length"),
        ({"kind": "pattern", "rows": "#"}, "must leave at least 25% of the box"),
        (
            {"x": 500, "y": 8},
            r"`obstacles.0.x` must be at most 48, the width of the box; got 500",
        ),
        ({"x": 8, "y": 48.5}, r"`obstacles.0.y` must be at most 48"),
        (
            {"kind": "wall", "x0": 8, "y0": 8, "x1": 8, "y1": 60},
            r"`obstacles.0.y1` must be at most 48",
        ),
        ({"kind": "hedge"}, "`kind` must be one of post, wall, pattern, got 'hedge'"),
    ],
)
def test_impossible_obstacles_are_refused(obstacle, message):
    with pytest.raises(ValidationError, match=message):
        spec.World.model_validate({"obstacles": [obstacle]})


@pytest.mark.parametrize("y", [24, 25.9, 27])
def test_a_body_that_starts_in_or_at_an_obstacle_is_refused(y):
    box = spec.World(obstacles=(spec.Post(x=24, y=y, radius=2),))
    with pytest.raises(ValidationError, match=r"`world.obstacles` must leave 2 cells"):
        spec.Scene(world=box)


def test_every_trial_needs_room():
    box = spec.World(obstacles=(spec.Post(x=24, y=34, radius=2),))
    spec.Scene(world=box)
    with pytest.raises(ValidationError, match="in trial 3"):
        spec.Scene(world=box, task=spec.Task(trials=3))


@pytest.mark.parametrize(
    ("trait", "x", "y"),
    [
        # A chain of 23 cells along x: its end is 11.5 from the middle, or twice as far.
        ({"rest_length": {"low": 1.0, "high": 2.0}}, 55, 32),
        ({"rest_angle": {"low": -3.0, "high": 3.0}}, 32, 42),
    ],
)
def test_a_body_of_inherited_shape_needs_room_for_its_largest(trait, x, y):
    post = spec.Post(x=x, y=y, radius=1)
    box = spec.World(width=64, height=64, obstacles=(post,))
    spec.Scene(world=box, control=spec.Direct())
    with pytest.raises(ValidationError, match=r"`world.obstacles` must leave 2 cells"):
        spec.Scene(world=box, control=spec.Direct(**trait))


def test_copies_keep_apart_at_their_largest():
    copies = {"count": 2, "arrangement": "row", "spacing": 30}
    world = {"width": 128, "height": 128, "copies": copies}
    control = {"encoding": "direct"}
    spec.Scene.model_validate({"world": world, "control": control})
    longer = control | {"rest_length": {"low": 1.0, "high": 2.0}}
    with pytest.raises(ValidationError, match=r"spacing` must be at least 49 cells"):
        spec.Scene.model_validate({"world": world, "control": longer})


def test_elites_are_not_evaluated_again_at_random_places_among_obstacles():
    box = {"obstacles": [{"kind": "post", "x": 4, "y": 4}]}
    search = {"reevaluation": {"pose": True}}
    with pytest.raises(ValidationError, match=r"`search.reevaluation.pose` must be false"):
        spec.QualityDiversity.model_validate({"world": box, "search": search})
