"""Specs: valid combinations, refusals and estimates."""

import re
import subprocess
import sys

import pytest
from pydantic import ValidationError

from microcosmos import spec
from microcosmos.spec import EXPERIMENTS, QualityDiversity, Scene, estimate, field_path, parse

pytestmark = pytest.mark.fast


def refusal(**changes) -> str:
    """Every refused field of a search and the reason."""
    with pytest.raises(ValidationError) as caught:
        parse({"experiment": "quality-diversity", **changes})
    return "\n".join(f"{field_path(e['loc'])}: {e['msg']}" for e in caught.value.errors())


@pytest.mark.parametrize(
    "preset", EXPERIMENTS["quality-diversity"].presets, ids=lambda p: p.name
)
def test_a_preset_survives_json(preset):
    assert parse(preset.spec.model_dump(mode="json")) == preset.spec


AXES = [{"name": "bending_effort", "low": 0}, {"name": "stretching_effort"}]
LOOP = {"builder": "ring", "nodes": 12}
GROWN = {"encoding": "cppn-body"}
MANY = {"control": GROWN | {"min_nodes": 20}, "body": {"nodes": 12}}
NARROW = {"body": {"nodes": 62}, "world": {"width": 80}}
LARGE = {"body": {"nodes": 256}, "world": {"width": 512, "height": 512}}


def direct(**words):
    return {"control": {"encoding": "direct", **words}}


def free(low, high):
    return {"low": low, "high": high}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"world": {"colour": "blue"}}, "world.colour"),
        ({"world": {"viscosity": -0.1}}, "world.viscosity: Input should be .* 0.001"),
        ({"world": {"viscosity": float("nan")}}, "world.viscosity"),
        ({"body": {"nodes": 10**9}}, "body.nodes"),
        ({"world": {"width": 24}}, "`world.width` must be at least 30"),
        ({"body": {"nodes": 62}}, "`world.width` must be at least 72 cells"),
        (NARROW, "`world.height` must be at least 72 cells"),
        ({"coupling": {"theta_feedback": 0}}, "`projection` must be 'none' or 'force'"),
        ({"world": {"magic": "fixed", "viscosity": 0.001}}, "`magic` must be"),
        ({"archive": {"descriptors": [AXES[1]] * 2}}, "`descriptors` must not repeat"),
        ({"archive": {"descriptors": AXES}}, "`low` must be above 0"),
        ({"control": {"sense_energy": True}}, "`world.energy` must be set where `control"),
        ({"task": {"fitness": "energy"}}, "`world.energy` must be set where `task.fitness`"),
        (
            {"control": {**QualityDiversity().control.model_dump(), "encoding": "l-system"}},
            "control: .*must be one of .*direct.*, got 'l-system'",
        ),
        ({"body": {"nodes": 1025}}, "`lag` 0 for a body of more than 1,024"),
        (direct(bend=free(0.5, 0.4)), "control.bend: .*above `low`"),
        (direct(bend=free(0.5, 2)), "control: .*0 to 1"),
        (direct(waveform="table", terms=1), "control: .*at least 2"),
        (direct(rest_length=free(1.0, 2.0)), "at least 55 cells"),  # 31 × 2 × 1.1 + 4
        ({"control": GROWN, "body": {"builder": "arc"}}, "must be 'chain'"),
        ({"control": GROWN | {"anatomy": True}}, "control: .*`anatomy` must be false"),
        (MANY, "at most the body's 12 nodes"),
        (direct(terms=256) | LARGE, "at most 65536 genes"),
        (
            {"control": GROWN, "genome": {"max_nodes": 10}},
            "`genome.max_nodes` must be at least 13",
        ),
    ],
    ids=str,
)
def test_a_spec_that_cannot_be_carried_out_is_refused_with_the_field_and_reason(changes, words):
    assert re.search(words, refusal(**changes))


POPULATION = {"operator": "population"}
BACKEND = POPULATION | {"backend": "tensorneat"}


@pytest.mark.parametrize("operator", ["random", "neat", "lamarckian", "population"])
def test_emitters_that_number_genes_stand_beside_each_other_but_not_beside_tensorneat(operator):
    other = {"operator": operator}
    for emitters in ([other, other], [other, POPULATION], [{"operator": "neat"}, other]):
        spec = parse({"experiment": "quality-diversity", "search": {"emitters": emitters}})
        assert len(spec.emitters) == 2
    beside = {"search": {"emitters": [BACKEND, other]}}
    if operator == "random":
        parse({"experiment": "quality-diversity", **beside})
    else:
        assert 'nothing but random beside backend "tensorneat"' in refusal(**beside)


def test_an_unknown_encoding_or_experiment_is_refused_with_the_known_ones():
    with pytest.raises(ValidationError, match=r"`encoding` must be .*direct.*got 'l-system'"):
        Scene.model_validate({"control": {"encoding": "l-system"}})
    with pytest.raises(ValidationError, match="'quality-diversity'"):
        parse({"experiment": "astrology"})


def test_a_gait_needs_the_body_of_its_swimmer():
    scene = Scene.model_validate({"control": {"swimmer": "ray"}, "body": {"builder": "ray"}})
    assert isinstance(scene.control, spec.Gait)
    with pytest.raises(
        ValidationError, match=r"`body\.builder` must be 'ray' for its gait, got"
    ):
        Scene.model_validate({"control": {"swimmer": "ray"}, "body": {"builder": "worm"}})


@pytest.mark.parametrize(
    "parts",
    [
        direct(bend=free(0.5, 0.9)) | {"body": LOOP},
        direct(rest_length=free(1.0, 2.0)) | {"world": {"width": 80, "height": 80}},
    ],
)
def test_a_scene_that_fits_is_accepted(parts):
    Scene.model_validate(parts)


def test_limits_follow_the_viscosity_unless_they_are_given():
    coupling = QualityDiversity().coupling
    assert coupling.displacement_limit(0.05) == 0.1
    assert coupling.force_limit(0.001) == 0.03
    assert coupling.model_copy(update={"limits": False}).force_limit(0.05) is None


def test_memory_grows_with_the_block_and_work_with_the_steps():
    small = QualityDiversity()
    large = parse({**small.model_dump(), "search": {"block": 1024}})
    longer = parse({**small.model_dump(), "task": {"steps": 4000}})
    assert estimate(large).memory_bytes > 32 * estimate(small).memory_bytes
    assert estimate(longer).cell_steps == 2 * estimate(small).cell_steps


@pytest.mark.parametrize(
    "module",
    ["spec", "bodies", "archive.creature", "archive.export", "cli", "client", "doctor"],
)
def test_importing_it_loads_no_jax(module):
    code = f"import sys, microcosmos.{module}; sys.exit('jax' in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_only_forms_without_projection_can_push_themselves():
    for projection in ("force", "force+torque"):
        assert spec.Coupling(projection=projection).force_free
    assert not spec.Coupling(projection="none").force_free


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


def test_genes_are_counted_part_by_part():
    body = spec.shape(spec.Chain(nodes=10))
    free = spec.Bounds(low=0.5, high=1.0)
    direct = spec.Direct(bend=free, rest_length=free, waveform="table", terms=3)
    assert direct.parts(body) == {"rest_length": 9, "bend": 8, "angles": 24, "lengths": 27}
    assert spec.gene_count(direct, body) == 68
    assert spec.gene_count(spec.Control(), body) == 0


def test_strategies_of_cma_mae_have_equal_parts_of_the_offspring():
    emitters = [{"operator": "cma-mae", "emitters": 3}, {"operator": "iso+line"}]
    whole = {"experiment": "quality-diversity", "control": {"encoding": "direct"}}
    spec = parse(whole | {"search": {"batch": 24, "emitters": emitters}})
    assert spec.emitters[0].emitters == 3
    with pytest.raises(ValueError, match=r"must divide its 16 offspring .* evenly, got 3"):
        parse(whole | {"search": {"batch": 32, "emitters": emitters}})


def test_a_bandit_divides_among_several_emitters_that_learn_nothing():
    neat, learner = {"operator": "neat"}, {"operator": "cma-mae"}
    search = {"bandit": {"window": 10}, "emitters": [neat, {"operator": "random"}]}
    found = parse({"experiment": "quality-diversity", "search": search | {"screening": {}}})
    assert (found.search.bandit.window, found.search.bandit.exploration) == (10, 0.05)
    alone = refusal(search=search | {"emitters": [neat]})
    assert re.search("search: .*`emitters` must be at least two with `bandit`, .* got 1", alone)
    learning = refusal(
        **direct(), search=search | {"emitters": [learner, {"operator": "random"}]}
    )
    assert re.search("must be among random, neat, .* with `bandit`, got 'cma-mae'", learning)
    assert "search.bandit.window" in refusal(search=search | {"bandit": {"window": 0}})


def test_fronts_need_a_second_objective_that_is_not_the_fitness():
    def fronts(fitness="speed", **container):
        chosen = {"container": {"kind": "fronts"} | container}
        return {"archive": chosen, "task": {"fitness": fitness}}

    found = parse({"experiment": "quality-diversity"} | fronts(size=4))
    container = found.archive.container
    assert (container.measure, container.goal) == ("cost_of_transport", "least")
    assert found.archive.places == 4 * found.archive.cells
    same = [("speed", "speed"), ("cost_of_transport", "cost_of_transport")]
    for fitness, measure in [*same, ("displacement", "displacement")]:
        told = refusal(**fronts(fitness, measure=measure, goal="most"))
        assert "`archive.container.measure` must be another measure" in told
        assert f"got {measure!r}" in told
    assert "archive.container.size: " in refusal(**fronts(size=1))
    assert "`search.reevaluation.decides` must be false with `archive.container`" in refusal(
        **fronts(), search={"reevaluation": {"decides": True}}
    )
    assert "`search.screening` must be empty with `archive.container`" in refusal(
        **fronts(), search={"screening": {}}
    )
