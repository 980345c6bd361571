"""Bodies in a spec: every builder, refusals, and drawings."""

from typing import get_args

import networkx
import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from microcosmos import spec
from microcosmos.spec import EXPERIMENTS, drawing, field_path, parse
from microcosmos.spec.body import Body, Swimmer

pytestmark = pytest.mark.fast

TRIANGLE = [[0, 0], [3, 0], [0, 3]]
BUILT = {
    "chain": ({"nodes": 7}, 7, 6),
    "ring": ({"nodes": 9}, 9, 9),
    "arc": ({"nodes": 8, "gap": 0.3}, 8, 7),
    "star": ({"arms": 3, "arm_nodes": 4}, 13, 12),
    "tree": ({"levels": 2, "branches": 2, "segment_nodes": 3}, None, None),
    "polyline": ({"points": [[0, 0], [4, 0], [4, 3]]}, 8, 7),
    "graph": ({"nodes": TRIANGLE, "edges": [[0, 1], [1, 2], [2, 0]]}, 3, 3),
}
WHOLE = TypeAdapter(Body)


APART = {
    "nodes": [[x, 0] for x in (0, 1, 2, 64, 65, 66)],
    "edges": [[0, 1], [1, 2], [3, 4], [4, 5]],
}


def refusal(body):
    with pytest.raises(ValidationError) as caught:
        parse({"experiment": "quality-diversity", "body": body})
    return "\n".join(f"{field_path(e['loc'])}: {e['msg']}" for e in caught.value.errors())


@pytest.mark.parametrize("builder", [*BUILT, *get_args(Swimmer)])
def test_every_builder_makes_one_connected_body_that_survives_json(builder):
    measures, nodes, edges = BUILT.get(builder, ({}, None, None))
    written = WHOLE.validate_python({"builder": builder, **measures})
    assert WHOLE.validate_python(written.model_dump(mode="json")) == written
    body = spec.shape(written)
    if nodes:
        assert (len(body.positions), len(body.edges)) == (nodes, edges)
    graph = networkx.Graph(body.edges.tolist())
    assert len(graph) == len(body.positions)
    assert networkx.is_connected(graph)


def test_a_body_that_names_no_builder_is_a_chain():
    chosen = parse({"experiment": "quality-diversity", "body": {"nodes": 12}})
    assert chosen.body == spec.Chain(nodes=12)


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ({"builder": "ring", "nodes": 3}, "body.nodes: Input should be greater"),
        ({"builder": "arc", "gap": 1}, "body.gap: Input should be less than 1"),
        ({"builder": "ring", "gap": 0.2}, "body.gap: Extra inputs"),
        ({"builder": "worm", "stretch": 1}, "body.stretch: Extra inputs"),
        ({"builder": "graph", "nodes": TRIANGLE, "edges": [[0, 1], [1, 5]]}, "0 to 2, got 5"),
        (
            {"builder": "graph", "nodes": [*TRIANGLE, [9, 9]], "edges": [[0, 1], [1, 2]]},
            "`edges` must join every node; node 3 is in none",
        ),
        ({"builder": "graph", "nodes": TRIANGLE, "edges": [[0, 1], [1, 0]]}, "0 and 1 twice"),
        ({"builder": "star", "arms": 64, "spacing": 0.5}, "0.25 cells apart"),
        # The second filament lies on the image of the first.
        ({"builder": "graph", **APART}, "at least 71 cells for a `body` that reaches 66 cells"),
        ({"builder": "polyline", "points": [[0, 0], [0, 0]]}, "must not all be the same"),
    ],
    ids=lambda value: value if isinstance(value, str) else value["builder"],
)
def test_an_impossible_body_is_refused_with_the_reason(body, reason):
    assert reason in refusal(body)


@pytest.mark.parametrize("body", [5, None, "ring", [1], {"builder": "snake"}])
def test_what_names_no_builder_is_refused_with_the_known_ones(body):
    text = refusal(body)
    assert "`builder` must be one of chain, ring" in text
    assert "jellyfish" in text


@pytest.mark.parametrize(
    "body",
    [
        {"builder": "tree", "levels": 8, "branches": 4, "segment_nodes": 256},
        {"builder": "star", "arms": 64, "arm_nodes": 1024},
        {"builder": "polyline", "points": [[0, 0], [1e300, 0]]},
    ],
    ids=lambda body: body["builder"],
)
def test_a_body_of_too_many_nodes_is_refused_before_it_is_made(body):
    assert "at most 4096 nodes" in refusal(body)


PRESETS = [
    pytest.param(preset.spec, id=f"{experiment.name}-{preset.name}")
    for experiment in EXPERIMENTS.values()
    for preset in experiment.presets
]
BODIES = [
    *({"builder": builder, **measures} for builder, (measures, *_) in BUILT.items()),
    *({"builder": swimmer} for swimmer in get_args(Swimmer)),
    {"builder": "walk", "nodes": 60},
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


def test_a_drawing_shows_copies_and_obstacles():
    copies = {"count": 3, "arrangement": "row", "spacing": 30}
    world = {"width": 128, "height": 96, "copies": copies}
    world["obstacles"] = [{"kind": "post", "x": 20, "y": 80, "radius": 4}]
    found = drawing(parse({"experiment": "quality-diversity", "world": world}))
    (drawn,) = found.bodies
    assert drawn.nodes == len(drawn.positions) == 3 * 24
    first, second, third = drawn.positions.reshape(3, 24, 2)
    np.testing.assert_allclose(second - first, np.full((24, 2), (30, 0)), atol=1e-9)
    np.testing.assert_allclose((first + third) / 2, second, atol=1e-9)
    ends = drawn.edges.reshape(3, -1)
    np.testing.assert_array_equal(ends - ends[0], np.arange(3)[:, None] * 24 + 0 * ends)
    assert found.solid[20, 80]
    assert not found.solid[64, 48]
    assert drawing(parse({"experiment": "quality-diversity"})).solid is None
