"""A plug-in task over HTTP: on a worker with its module, beside one without."""

import json
import shutil
import subprocess
import sys
from hashlib import sha256

import pytest
from drive import ROOT, SUPERVISOR, wait_until

from microcosmos.archive import file

pytestmark = pytest.mark.long

EXAMPLE = ROOT / "examples" / "plugin_task.py"
SMALL = {
    "experiment": "quality-diversity",
    "world": {"width": 24, "height": 24},
    "body": {"builder": "plugin_task.cross", "plugin": {"settings": {"long": 3}}},
    "control": {"period": 20},
    "task": {"fitness": "plugin_task.straight", "steps": 20},
    "archive": {
        "descriptors": [
            {"name": "plugin_task.sway", "bins": 4},
            {"name": "displacement", "bins": 4},
        ]
    },
    "search": {"generations": 2, "batch": 4, "block": 4},
}


@pytest.fixture
def start_plugin_worker(tmp_path):
    """Starts a second worker of an installation, with the example."""
    hired = []
    module = shutil.copy(EXAMPLE, tmp_path)

    def start(product):
        other, *_ = product.named(SUPERVISOR)
        environment = other.environ() | {"MICROCOSMOS_MODULES": str(module)}
        command = [sys.executable, "-m", SUPERVISOR, "0"]
        with (product.folder / "hired.txt").open("ab") as output:
            streams = {"stdout": output, "stderr": output}
            hired.append(subprocess.Popen(command, cwd=ROOT, env=environment, **streams))
        return wait_until(lambda: worker_with_plugins(product), 60, "it reports its plug-ins")

    yield start
    for process in hired:
        process.terminate()
        process.wait(30)


def worker_with_plugins(product):
    return next((one for one in product.get("workers") if one["plugins"]), None)


def test_a_plug_in_task_is_refused_and_evolved(product, start_plugin_worker):
    wait_until(lambda: product.get("workers"), 60, "its workers live")
    refused = product.http.post("/api/v1/runs", json=SMALL)
    assert refused.status_code == 422
    messages = {one["field"]: one["reason"] for one in refused.json()["errors"]}
    assert "no worker has 'plugin_task.straight'" in messages["task.fitness"]
    worker = start_plugin_worker(product)
    names = [f"plugin_task.{name}" for name in ("straight", "sway", "cross")]
    assert {one["name"] for one in worker["plugins"]} == set(names)
    run = product.submit(SMALL)
    done = product.wait(run, "finished", seconds=240)
    log = product.get(f"runs/{run}/log")["entries"]
    assert any(f"begins on worker {worker['name']}" in entry["text"] for entry in log)
    tree, attributes = file.load(product.archive(run))
    spec = json.loads(attributes["spec"])
    assert spec == done["spec"]
    assert spec["task"]["plugin"]["source"] == sha256(EXAMPLE.read_bytes()).hexdigest()
    measures = json.loads(attributes["measures"])
    assert measures[-2:] == ["plugin_task.straight", "plugin_task.sway"]
    archive = product.get(f"runs/{run}/archive", measures="plugin_task.straight")
    assert archive["measures"]["plugin_task.straight"] == archive["fitness"]
    assert archive["fitness"] == tree["archive"]["fitness"].tolist()
