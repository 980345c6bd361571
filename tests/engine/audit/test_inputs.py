"""The page's worker repeats evaluations from the inputs in a file, bit by bit."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from microcosmos import device, naming, spec, world
from microcosmos.archive import columns
from microcosmos.audit import evaluation_inputs
from microcosmos.build import build

pytestmark = pytest.mark.optimised

WEB = Path(__file__).parents[3] / "web"
ASSETS = WEB / "dist" / "assets"
NODE = shutil.which(
    "node", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
)
CREATURES = 20

SMALL = {
    "experiment": "quality-diversity",
    "world": {"width": 32, "height": 28},
    "body": {"nodes": 10},
    "control": {"period": 20},
    "task": {"steps": 50},
    "search": {"generations": 20, "batch": 16, "block": 8},
}
VECTORS = {"search": {"emitters": [{"operator": "iso+line"}]}}
QUICK = {
    "a wave of one joint, which is −0": {"body": {"nodes": 3}},
    "a network, four trials": {"task": {"trials": 4}},
    "direct": VECTORS | {"control": {"encoding": "direct"}},
}
CASES = {
    "a network": {},
    "a recurrent network": {"control": {"recurrent": True}},
    "a plan": {"control": {"encoding": "body-graph"}, "body": {"builder": "grown"}},
    "a sense, a world with energy that is taken": {
        "world": {"energy": {"consume": True, "diffusion": 0.05}},
        "control": {"sense_energy": True},
        "task": {"fitness": "displacement+energy"},
    },
    "three placements and three trials": {
        "world": {"energy": {"placements": 3}},
        "task": {"fitness": "energy", "trials": 3},
    },
    "copies": {"world": {"width": 64, "height": 64, "copies": {"count": 2, "spacing": 12}}},
    "a soft body": {"body": {"bend": 0.5}},
    "a body that repels itself": {"world": {"steric": {}}},
}


GAITS = {
    "experiment": "gaits",
    "viscosities": [0.002, 0.05, 0.3, 2.0],
    "forms": ["ours"],
    "period": 60,
    "cycles": 2,
}
QUICK_SWEEPS = {"actuators of finite strength": {}}
SWEEPS = {
    "one cycle": {"cycles": 1, "period": 100},
    "actuators of constant strength": {"forms": ["strong"]},
    "the paper's coupling": {"forms": ["paper"]},
    "repulsion": {"steric": {}},
}


@pytest.fixture
def evaluated(tmp_path):
    """A function that gives the answers of the page's worker to files of inputs."""
    if not NODE:
        pytest.skip("needs node")
    if not ASSETS.exists():
        pytest.skip("needs the built page")

    def run(files):
        places = [tmp_path / str(number) for number in range(len(files))]
        for place, content in zip(places, files, strict=True):
            place.write_bytes(content)
        command = [NODE, WEB / "scripts" / "evaluate.mjs", ASSETS, *places]
        return json.loads(subprocess.check_output(command))

    return run


def creatures(parts):
    """Evolve until there are `CREATURES` elites, and return their files."""
    changed = {name: SMALL[name] | fields for name, fields in parts.items()}
    experiment = build(spec.parse(SMALL | changed))
    state, found = experiment.init(), {}
    while len(found) < CREATURES and not experiment.done(state):
        state, report = experiment.advance(state)
        for elite in report.elites:
            identity = json.loads(elite.identity)
            found[elite.creature] = naming.document(identity, elite.measured, elite.provenance)
    return list(found.values())[:CREATURES]


def swimmers(parts):
    """Return the files of the five swimmers with their gaits, at every viscosity."""
    experiment = build(spec.parse(GAITS | parts))
    state = experiment.init()
    while not experiment.done(state):
        state, _ = experiment.advance(state)
    return [
        naming.document(json.loads(row.identity), row.measured, row.provenance)
        for row in state.rows
    ]


def texts(numbers):
    """Return the text of each number, in which −0 differs from 0."""
    return {name: repr(float(number)) for name, number in numbers.items()}


def cases(quick, others):
    long = [pytest.param(one, id=name, marks=pytest.mark.long) for name, one in others.items()]
    return [*(pytest.param(one, id=name) for name, one in quick.items()), *long]


@pytest.mark.parametrize("parts", cases(QUICK, CASES))
def test_the_page_finds_every_recorded_number_of_twenty_creatures(parts, evaluated):
    if not device.kernel_version():
        pytest.skip("microcosmos-kernels is not installed: no compiler?")
    files = creatures(parts)
    assert len(files) == CREATURES
    answers = evaluated([evaluation_inputs(file) for file in files])
    for file, answer in zip(files, answers, strict=True):
        figures, measured = answer["found"]["figures"], file["measured"]
        recorded = measured["measures"] | {"fitness": measured["fitness"]}
        assert texts(figures) == texts(recorded)


def compare_gaits(files, evaluated):
    """Compare all that is recorded of gaits with what the page finds of them."""
    assert len(files) == CREATURES
    answers = evaluated([evaluation_inputs(file) for file in files])
    for file, answer in zip(files, answers, strict=True):
        figures, measured = answer["found"]["figures"], file["measured"]
        recorded = measured["measures"] | {"fitness": measured["fitness"]}
        assert texts({name: figures[name] for name in recorded}) == texts(recorded)


@pytest.mark.parametrize("parts", cases(QUICK_SWEEPS, SWEEPS))
def test_the_page_finds_every_recorded_number_of_the_five_swimmers(parts, evaluated):
    if not device.kernel_version():
        pytest.skip("microcosmos-kernels is not installed: no compiler?")
    compare_gaits(swimmers(parts), evaluated)


def test_inputs_say_what_the_kernel_lacks(monkeypatch):
    (file, *_) = creatures({})
    monkeypatch.setattr(world.native, "uncovered", lambda *_: "such a world")
    header, arrays = columns.load(evaluation_inputs(file))
    assert header["uncovered"] == "such a world"
    assert not arrays


def test_inputs_of_another_size_are_refused(evaluated):
    content = evaluation_inputs(creatures({})[0])
    wrong = content.replace(b'"nodes":10', b'"nodes":11', 2)
    (answer,) = evaluated([wrong])
    assert answer["error"] == "The array positions needs 22 items, got 20."
