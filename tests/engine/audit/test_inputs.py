"""The page's worker repeats evaluations from the inputs in a file, bit by bit."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from microcosmos import device, naming, spec
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
    "a network, four trials": {"task": {"trials": 4}},
    "direct": VECTORS | {"control": {"encoding": "direct"}},
}
CASES = {
    "a network": {},
    "a recurrent network": {"control": {"recurrent": True}},
    "a body that grows": {"control": {"encoding": "cppn-body"}},
    "a plan": {"control": {"encoding": "body-graph"}, "body": {"builder": "grown"}},
    "weights": VECTORS | {"control": {"encoding": "weights"}},
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


def cases():
    long = [pytest.param(one, id=name, marks=pytest.mark.long) for name, one in CASES.items()]
    return [*(pytest.param(one, id=name) for name, one in QUICK.items()), *long]


@pytest.mark.parametrize("parts", cases())
def test_the_page_finds_every_recorded_number_of_twenty_creatures(parts, evaluated):
    if not device.kernel_version():
        pytest.skip("microcosmos-kernels is not installed: no compiler?")
    files = creatures(parts)
    assert len(files) == CREATURES
    answers = evaluated([evaluation_inputs(file) for file in files])
    for file, answer in zip(files, answers, strict=True):
        figures, measured = answer["found"]["figures"], file["measured"]
        assert figures == measured["measures"] | {"fitness": measured["fitness"]}


def test_inputs_say_what_the_kernel_lacks():
    gait = {"experiment": "gaits", "swimmers": ["worm"], "viscosities": [0.1], "period": 20}
    experiment = build(spec.parse(gait | {"cycles": 1, "forms": ["ours"]}))
    state, _ = experiment.advance(experiment.init())
    (row,) = state.rows
    file = naming.document(json.loads(row.identity), row.measured, row.provenance)
    header, arrays = columns.load(evaluation_inputs(file))
    assert header["uncovered"] == "the measures of a gait"
    assert not arrays


def test_inputs_of_another_size_are_refused(evaluated):
    content = evaluation_inputs(creatures({})[0])
    wrong = content.replace(b'"nodes":10', b'"nodes":11', 2)
    (answer,) = evaluated([wrong])
    assert answer["error"] == "The array positions needs 22 items, got 20."
