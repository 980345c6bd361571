"""What is drawn of a spec before it runs."""

import numpy as np
import pytest

from microcosmos.spec import EXPERIMENTS, drawing, parse

pytestmark = pytest.mark.fast

PRESETS = [
    pytest.param(preset.spec, id=f"{experiment.name}-{preset.name}")
    for experiment in EXPERIMENTS.values()
    for preset in experiment.presets
]
BODIES = [
    {"builder": "chain"},
    {"builder": "ring"},
    {"builder": "arc"},
    {"builder": "walk", "nodes": 60},
    {"builder": "star"},
    {"builder": "tree"},
    {"builder": "polyline", "points": [[0, 0], [10, 0], [10, 8]]},
    {"builder": "graph", "nodes": [[0, 0], [2, 0], [4, 1]], "edges": [[0, 1], [1, 2]]},
    *({"builder": name} for name in ("worm", "tadpole", "ray", "cilia", "jellyfish")),
]


@pytest.mark.parametrize("spec", PRESETS)
def test_a_drawing_is_small_and_whole(spec):
    found = drawing(spec)
    assert found.bodies
    for body in found.bodies:
        assert len(body.positions) <= 1300
        assert body.edges.min() >= 0
        assert body.edges.max() < len(body.positions)


@pytest.mark.parametrize("body", BODIES, ids=lambda body: body["builder"])
def test_every_body_lies_in_the_middle_of_its_world(body):
    world = {"width": 128, "height": 96}
    found = drawing(parse({"experiment": "quality-diversity", "world": world, "body": body}))
    assert (found.width, found.height) == (128, 96)
    (drawn,) = found.bodies
    assert drawn.nodes == len(drawn.positions)
    np.testing.assert_allclose(drawn.positions.mean(0), (64, 48), atol=1e-9)
    assert (drawn.positions > 0).all()
    assert (drawn.positions < (128, 96)).all()


def test_a_fold_shows_its_pictures_and_a_sweep_its_swimmers():
    folds = drawing(parse({"experiment": "folding"}))
    assert [name for name, _ in folds.pictures] == [str(digit) for digit in range(10)]
    assert all(ink.max() > 0.5 for _, ink in folds.pictures)
    sweep = drawing(parse({"experiment": "gaits", "swimmers": ["cilia", "ray"]}))
    assert [body.name for body in sweep.bodies] == ["cilia", "ray"]


def test_a_crowd_is_drawn_by_some_of_its_filaments_within_the_box():
    found = drawing(parse({"experiment": "scaling"}))
    few, many = found.bodies
    assert (few.nodes, many.nodes) == (1_000, 500_000)
    assert (len(few.edges), len(many.edges)) == (50, 600)
    assert (few.whole, many.whole) == (True, False)
    lengths = np.hypot(*np.diff(many.positions.reshape(-1, 2, 2), axis=1)[:, 0].T)
    np.testing.assert_allclose(lengths, 19 * 0.35)
    assert many.positions.min() > 0
    assert many.positions.max() < 256
