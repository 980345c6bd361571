"""Bodies, lengths and sperm numbers of evolved creatures are those that the engine develops."""

import json

import jax
import numpy as np
import pytest

import microcosmos as mc
from microcosmos.archive import creature
from microcosmos.audit.variants import body_of as developed_body
from microcosmos.build import build_task
from microcosmos.genomes import Drive
from microcosmos.quantities import bodies, files
from microcosmos.search import drive
from microcosmos.viz.replay import actuator_of

pytestmark = pytest.mark.long

PERIOD = 20
GROWN = {"builder": "grown", "nodes": 24, "length": 20.0, "segments": 3}
STIFF = {"max_speed": None, "max_bend": None, "lag": 0, "period": PERIOD}
CASES = {
    "soft plan": ({"encoding": "body-graph", "softest": 0.05, **STIFF}, GROWN),
    "plan": ({"encoding": "body-graph", **STIFF}, GROWN),
    "genes": (
        {
            "encoding": "direct",
            "bend": {"low": 0.1, "high": 0.8},
            "rest_length": {"low": 0.5, "high": 1.5},
            **STIFF,
        },
        {"nodes": 10},
    ),
}


def spec_of(name):
    control, body = CASES[name]
    axes = [{"name": "nodes", "bins": 4}, {"name": "curvature_mean", "bins": 4}]
    return mc.parse(
        {
            "experiment": "quality-diversity",
            "world": {"width": 40, "height": 40, "viscosity": 0.1},
            "body": body,
            "control": control,
            "task": {"steps": 2 * PERIOD},
            "archive": {"descriptors": axes},
            "search": {"generations": 1, "batch": 16, "block": 8, "feasible": False}
            | ({"emitters": [{"operator": "gaussian"}]} if name == "genes" else {}),
        }
    )


@pytest.fixture(scope="module", params=CASES)
def run(request, tmp_path_factory):
    path = tmp_path_factory.mktemp("run") / "run.h5"
    mc.evolve(spec_of(request.param), path)
    return request.param, path, json.loads(path.with_suffix(".best.json").read_bytes())


def test_the_body_is_the_one_that_the_engine_develops(run):
    best = run[2]
    file = creature.parse(best)
    scene = creature.scene_of(file)
    task = build_task(scene, room=creature.room(file))

    @jax.jit
    def develop(genotype):
        driven = drive(task, genotype)
        return (driven.world, driven.start, driven.inputs), driven.layout, driven.length

    given, layout, length = develop(actuator_of(file, scene))
    body, _, _ = developed_body(scene, Drive(*given, layout=layout))
    found = bodies.body_of(scene, file["identity"]["genome"])
    assert len(found.positions) == len(body.positions)
    # The rows of joints that the engine closes rings with stand elsewhere.
    np.testing.assert_allclose(np.sort(found.bend), np.sort(body.bend), rtol=1e-5)
    genes = file["identity"]["genome"]
    expected = task.length if length is None else float(length)
    assert bodies.length_of(scene, genes) == pytest.approx(expected, rel=1e-5)


def test_the_sperm_number_follows_from_the_slowest_joint(run):
    name, _, best = run
    file = creature.parse(best)
    scene = creature.scene_of(file)
    found = files.stroke(file)
    bend = bodies.body_of(scene, file["identity"]["genome"]).bend
    assert found.period == PERIOD
    if name == "plan":
        assert found.sperm == 0, "Stiff joints take their rest angles at once."
    elif name == "soft plan":
        softest = -1 / np.log(1 - bend.min())
        assert found.sperm == pytest.approx((2 * np.pi * softest / PERIOD) ** 0.25)
    else:
        # A chain is slower than each of its joints alone, and faster than one of the softest.
        alone = -1 / np.log(1 - bend.min()) / 10
        chain = 2 / (bend.min() * (np.pi / (len(bend) + 1)) ** 2) / 10
        low, high = ((2 * np.pi * t / PERIOD) ** 0.25 for t in (alone, chain))
        assert low < found.sperm < high
