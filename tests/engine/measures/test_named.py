"""A measure that a spec names is recorded, exported and repeated, by JAX and by the kernel."""

import json
from importlib.util import find_spec

import jax
import numpy as np
import pytest
from genotypes import any_genotype

from microcosmos import search
from microcosmos.archive import creature, export
from microcosmos.audit.reproducibility import check
from microcosmos.build import build, build_task, measures_of
from microcosmos.exports.run_file import RunFile
from microcosmos.exports.tables import archive
from microcosmos.measures import MEASURES, NAMED, RECORDED
from microcosmos.quantities import scales
from microcosmos.quantities.real import Real
from microcosmos.search.evaluation import measured
from microcosmos.spec import parse
from microcosmos.viz.figures import reading
from microcosmos.viz.figures.reading import chosen
from microcosmos.widgets import contents
from microcosmos.world import unwrapped

SPEC = {
    "experiment": "quality-diversity",
    "world": {"width": 24, "height": 24},
    "body": {"builder": "chain", "nodes": 8},
    "control": {"period": 20, "angle_scale": 0.5},
    "task": {"fitness": "displacement", "steps": 40},
    "archive": {
        "descriptors": [{"name": "tortuosity", "bins": 8}, {"name": "displacement", "bins": 4}]
    },
    "search": {"feasible": False, "generations": 2, "batch": 4, "block": 4},
}
KERNELS = ["jax", *(["native"] if find_spec("microcosmos_kernels") else [])]


@pytest.fixture(params=KERNELS, scope="module")
def course(request, carry_out):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MICROCOSMOS_KERNEL", request.param)
        experiment = build(parse(SPEC))
        states, reports = carry_out(experiment)
        yield experiment, states[-1], reports


def test_a_run_records_it_behind_the_others(course):
    experiment, state, reports = course
    assert experiment.plan.measures == (*RECORDED, "tortuosity")
    for elite in reports[0].elites:
        assert elite.descriptors[0] == elite.measures["tortuosity"]
        assert 1 <= elite.measures["tortuosity"] <= 1000
    data = experiment.save(state)
    assert experiment.save(experiment.restore(data)) == data


def test_it_is_in_every_form_of_the_archive(course):
    experiment, state, _ = course
    data, measure = experiment.save(state), MEASURES["tortuosity"]
    columns = export.columns(data)
    assert np.all(columns["tortuosity"] >= 1)
    exported = archive(RunFile("run", data))["tortuosity"]
    assert (exported.title, exported.unit) == (measure.title, "1")
    np.testing.assert_array_equal(exported.values, columns["tortuosity"])
    assert chosen(reading.read(data), ["tortuosity"])[0].label == "Tortuosity"
    for shown in (contents.of_file(data), contents.empty(parse(SPEC))):
        assert shown.recorded[-1]["title"] == measure.title
    real = Real(1e-3, 0.5)
    assert len(scales.of_archive(data, real)[0]) == len(columns["index"])


def test_a_creature_repeats_it_bit_for_bit(course):
    experiment, state, _ = course
    file = creature.parse(json.dumps(experiment.best(state)))
    assert creature.scene_of(file).measures == ("tortuosity",)
    found = check(file)
    assert "tortuosity" in found.repeated
    assert found.exact


@pytest.mark.parametrize("kernel", KERNELS)
def test_it_is_computed_from_the_motion_that_either_kernel_records(monkeypatch, kernel):
    monkeypatch.setenv("MICROCOSMOS_KERNEL", kernel)
    scene, rng = parse(SPEC).scene, np.random.default_rng(0)
    task = build_task(scene)

    @jax.jit
    def run(genotype):
        driven = search.drive(task, genotype)
        end, observed = search.simulate(driven)
        values, *_ = measured(task, driven, end, observed)
        return values["tortuosity"], driven.start.positions, unwrapped(driven.world, observed)

    found, start, later = jax.device_get(run(any_genotype(scene, task.encoding, rng)))
    middle = np.concatenate([start[None], later])[:, 4].astype(float)
    path = np.hypot(*np.diff(middle, axis=0).T).sum()
    assert found == pytest.approx(path / np.hypot(*(middle[-1] - middle[0])), rel=1e-4)


@pytest.mark.fast
def test_only_a_spec_that_names_it_records_it():
    assert tuple(sorted(NAMED)) == NAMED
    plain = parse({**SPEC, "archive": {"descriptors": [{"name": "symmetry"}]}})
    assert plain.scene.measures == ()
    assert "measures" not in plain.scene.model_dump(mode="json")
    assert measures_of(plain.scene) == RECORDED
    container = {"kind": "learned", "measures": ["tortuosity", "speed", "aspect"]}
    learned = {"descriptors": [{"name": "symmetry"}], "container": container}
    assert measures_of(parse({**SPEC, "archive": learned}).scene) == (*RECORDED, "tortuosity")
