"""Words for encodings: what each asks of the body, and where errors are."""

import pytest
from pydantic import ValidationError

from microcosmos import spec
from microcosmos.spec import Scene

pytestmark = pytest.mark.fast


def refusal(**parts):
    with pytest.raises(ValidationError) as caught:
        Scene.model_validate(parts)
    error = caught.value.errors()[0]
    return spec.field_path(error["loc"]), error["msg"]


def test_a_controller_that_names_no_encoding_is_a_cppn():
    assert isinstance(Scene.model_validate({"control": {"period": 30}}).control, spec.Control)
    for kind, words in (
        ("direct", spec.Direct),
        ("weights", spec.Weights),
        ("cppn-body", spec.Grown),
        ("cppn", spec.Control),
    ):
        scene = Scene.model_validate({"control": {"encoding": kind}})
        assert isinstance(scene.control, words)
        assert Scene.model_validate_json(scene.model_dump_json()) == scene


def test_an_unknown_encoding_is_named():
    field, said = refusal(control={"encoding": "l-system"})
    assert field == "control"
    assert "'direct'" in said
    assert "l-system" in said


def test_errors_name_the_field_without_the_union_s_tags():
    field, said = refusal(control={"encoding": "direct", "bend": {"low": 0.5, "high": 0.4}})
    assert (field, "above `low`" in said) == ("control.bend", True)
    field, said = refusal(control={"encoding": "direct", "bend": {"low": 0.5, "high": 2}})
    assert (field, "0 to 1" in said) == ("control", True)
    field, said = refusal(control={"encoding": "direct", "waveform": "table", "terms": 1})
    assert (field, "at least 2" in said) == ("control", True)


@pytest.mark.parametrize("name", ["rest_angle", "rest_length"])
def test_shapes_of_bodies_with_loops_are_not_free(name):
    bounds = {"low": 0.5, "high": 0.9}
    control = {"encoding": "direct", name: bounds}
    _, said = refusal(control=control, body={"builder": "ring", "nodes": 12})
    assert "without loops" in said
    soft = {"encoding": "direct", "bend": bounds}
    Scene.model_validate({"control": soft, "body": {"builder": "ring", "nodes": 12}})


def test_the_longest_body_must_fit():
    longer = {"encoding": "direct", "rest_length": {"low": 1.0, "high": 2.0}}
    _, said = refusal(control=longer)
    assert "at least 73 cells" in said  # 31 × 2 × 1.1 + 4
    Scene.model_validate({"control": longer, "world": {"width": 80, "height": 80}})


def test_only_chains_are_grown():
    _, said = refusal(control={"encoding": "cppn-body"}, body={"builder": "arc"})
    assert "must be 'chain'" in said
    _, said = refusal(control={"encoding": "cppn-body", "min_nodes": 20}, body={"nodes": 12})
    assert "at most the body's 12 nodes" in said


def test_vectors_have_a_bounded_length():
    control = {"encoding": "direct", "terms": 256}
    _, said = refusal(
        control=control,
        body={"nodes": 256},
        world={"width": 512, "height": 512},
    )
    assert "at most 65536 genes" in said


def test_genes_are_counted_part_by_part():
    body = spec.shape(spec.Chain(nodes=10))
    free = spec.Bounds(low=0.5, high=1.0)
    direct = spec.Direct(bend=free, rest_length=free, waveform="table", terms=3)
    assert direct.parts(body) == {"rest_length": 9, "bend": 8, "angles": 24, "lengths": 27}
    assert spec.gene_count(direct, body) == 68
    assert spec.gene_count(spec.Control(), body) == 0


def test_networks_have_room_for_all_that_leads_to_outputs():
    words = {"control": {"encoding": "cppn-body"}, "genome": {"max_nodes": 10}}
    with pytest.raises(ValidationError, match=r"`genome\.max_nodes` must be at least 11"):
        spec.QualityDiversity.model_validate(words)
