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
        (
            {"coupling": {"limits": False, "max_force": 0.05}},
            "`max_force` must be empty where `limits` is false; got 0.05",
        ),
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
        (
            {"body": {"nodes": 1025}, "world": {"width": 2048, "height": 2048}},
            "`lag` 0 for a body of more than 1,024",
        ),
        ({"body": {"nodes": 4096}}, "`world.width` must be at least 4509 cells for a `body`"),
        (direct(bend=free(0.5, 0.4)), "control.bend: .*above `low`"),
        (direct(bend=free(0.5, 2)), "control: .*0 to 1"),
        *(
            ({part: {name: 1e-50}}, f"{part}.*{name}: Input should be greater than or equal to")
            for part, name in (
                ("control", "max_speed"),
                ("control", "max_bend"),
                ("control", "angle_scale"),
                ("task", "energy_weight"),
                ("genome", "weight_step"),
            )
        ),
        (direct(spread=1e-300), "control.*spread: Input should be greater than or equal to"),
        (
            {"world": {"energy": {"amplitude": 1e-50}}},
            "amplitude: Input should be",
        ),
        (
            {"search": {"emitters": [{"operator": "iso+line", "iso": 1e-300}]}},
            "iso: Input should be greater than or equal to",
        ),
        (
            {"archive": {"descriptors": [AXES[1] | {"low": 0.1, "high": 0.1 + 1e-12}]}},
            "`high` must be further above `low` .*: 20 bins up to",
        ),
        (direct(waveform="table", terms=1), "control: .*at least 2"),
        (direct(rest_length=free(1.0, 2.0)), "at least 55 cells"),  # 31 × 2 × 1.1 + 4
        (direct(terms=256) | LARGE, "at most 65536 genes"),
        (
            {"control": {"anatomy": True}, "genome": {"max_nodes": 8}},
            "`genome.max_nodes` must be at least 12",
        ),
    ],
    ids=str,
)
def test_a_spec_that_cannot_be_carried_out_is_refused_with_the_field_and_reason(changes, words):
    assert re.search(words, refusal(**changes))


POPULATION = {"operator": "population"}


@pytest.mark.parametrize("operator", ["random", "neat", "population"])
def test_emitters_that_number_genes_stand_beside_each_other(operator):
    other = {"operator": operator}
    for emitters in ([other, other], [other, POPULATION], [{"operator": "neat"}, other]):
        spec = parse({"experiment": "quality-diversity", "search": {"emitters": emitters}})
        assert len(spec.emitters) == 2


def test_a_gait_needs_the_body_of_its_swimmer():
    scene = Scene.model_validate({"control": {"swimmer": "ray"}, "body": {"builder": "ray"}})
    assert isinstance(scene.control, spec.Gait)
    with pytest.raises(
        ValidationError, match=r"`body\.builder` must be 'ray' for its gait, got"
    ):
        Scene.model_validate({"control": {"swimmer": "ray"}, "body": {"builder": "worm"}})


def test_memory_grows_with_the_block_and_work_with_the_steps():
    small = QualityDiversity()
    large = parse({**small.model_dump(), "search": {"block": 1024}})
    longer = parse({**small.model_dump(), "task": {"steps": 4000}})
    assert estimate(large).memory_bytes > 32 * estimate(small).memory_bytes
    assert estimate(longer).cell_steps == 2 * estimate(small).cell_steps


def test_memory_counts_the_distances_of_a_pool():
    container = {"kind": "dominated-novelty", "size": 4096}
    crowd = {"archive": {"container": container}, "search": {"batch": 65_536, "block": 1}}
    found = estimate(parse({"experiment": "quality-diversity", **crowd}))
    assert found.memory_bytes > 4 * (4096 + 65_536) ** 2


@pytest.mark.parametrize("operator", ["cma-mae", "cma-me"])
def test_memory_counts_the_matrices_of_strategies(operator):
    def of(count):
        emitters = [{"operator": operator, "emitters": count}]
        search = {"batch": 64, "emitters": emitters}
        return QualityDiversity(control=control, search=search)

    control = spec.Direct(terms=8)
    genes = sum(control.parts(spec.shape(QualityDiversity().body)).values())
    assert genes > 400
    more = estimate(of(64)).memory_bytes - estimate(of(1)).memory_bytes
    assert more >= 63 * 4.4 * 4 * genes**2


@pytest.mark.parametrize(
    "module",
    ["spec", "bodies", "archive.creature", "archive.export", "cli", "client", "doctor"],
)
def test_importing_it_loads_no_jax(module):
    code = f"import sys, microcosmos.{module}; sys.exit('jax' in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_controller_that_names_no_encoding_is_a_cppn():
    assert isinstance(Scene.model_validate({"control": {"period": 30}}).control, spec.Control)
    for kind, words in (
        ("direct", spec.Direct),
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
    assert "`search.screening` must be empty with `archive.container`" in refusal(
        **fronts(), search={"screening": {}}
    )


@pytest.mark.parametrize("fitness", ["speed", "upstream", "through"])
@pytest.mark.parametrize(("period", "steps"), [(200, 399), (200, 250), (100_000, 2000)])
def test_a_fitness_over_strokes_needs_two_of_them(fitness, period, steps):
    posts = [{"kind": "post", "x": 4, "y": 4, "radius": 2}]
    parts = {
        "world": {
            "width": 96,
            "height": 64,
            "flow": {"kind": "poiseuille"},
            "obstacles": posts,
        },
        "control": {"period": period},
    }
    refused = refusal(**parts, task={"fitness": fitness, "steps": steps})
    assert f"`task.steps` must be at least {2 * period}, two strokes of" in refused
    for task in ({"fitness": fitness, "steps": 2 * period}, {"fitness": "displacement"}):
        parse({"experiment": "quality-diversity", **parts, "task": task})


@pytest.mark.parametrize("number", [1e39, -1e39])
def test_fitness_beyond_single_precision_is_refused(number):
    stopping = refusal(search={"stop": {"fitness": number}})
    assert re.match(r"search.stop.fitness: .* equal to -?10{30}\b", stopping)
    emitter = {"operator": "cma-mae", "threshold": number}
    unreachable = refusal(**direct(), search={"emitters": [emitter]})
    assert re.match(r"search.emitters.0.threshold: .* equal to -?10{30}\b", unreachable)


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("seed", True),
        ("seed", "1"),
        ("world.viscosity", True),
        ("world.viscosity", "0.05"),
        ("world.width", False),
        ("control.period", "200"),
        ("control.max_speed", "0.3"),
        ("search.batch", True),
        ("archive.descriptors.0.bins", "4"),
        ("body.nodes", "12"),
    ],
)
def test_words_and_truth_values_are_no_numbers(path, value):
    document = QualityDiversity().model_dump(mode="json")
    *parents, last = path.split(".")
    part = document
    for name in parents:
        part = part[int(name) if name.isdigit() else name]
    part[last] = value
    with pytest.raises(ValidationError) as caught:
        parse(document)
    (error,) = spec.invalid_fields(caught.value.errors())
    assert error.field == path
    assert re.fullmatch(rf"needs a valid (number|integer); got {value!r}", error.reason)
