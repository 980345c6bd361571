"""Plug-ins of a worker: listed in another process, again when a file changes."""

import json
import subprocess
import sys
from pathlib import Path
from queue import Queue

import pytest

from microcosmos_server.settings import Settings
from microcosmos_worker import plugins

ROOT = Path(__file__).parents[2]
GOOD = """
from microcosmos import plugins
print("modules may print")

@plugins.body("stick", title="A stick", nodes=10)
def stick(): ...
"""


@pytest.fixture
def settings(tmp_path, monkeypatch):
    """A function that writes modules and makes the settings that name them."""
    monkeypatch.chdir(ROOT)

    def make(**modules):
        files = [tmp_path / f"{name}.py" for name in modules]
        for file, text in zip(files, modules.values(), strict=True):
            file.write_text(text)
        named = ":".join(map(str, files))
        monkeypatch.setenv("MICROCOSMOS_MODULES", named)
        return Settings(modules=named)

    return make


def test_a_worker_reports_its_plug_ins_and_failed_modules(settings):
    found = plugins.list_plugins(settings(mine=GOOD, broken="nothing", gone="raise SystemExit"))
    assert [one["name"] for one in found.plugins] == ["mine.stick"]
    assert len(found.plugin_versions) == 1
    reasons = {Path(one["module"]).stem: one["reason"] for one in found.unloaded}
    assert "NameError" in reasons["broken"]
    assert "SystemExit" in reasons["gone"]


def test_a_module_that_ends_its_process_or_never_ends_is_given_up(settings, monkeypatch):
    found = plugins.list_plugins(settings(mine=GOOD, bad="import os; os._exit(3)"))
    assert found.plugins == ()
    assert all("ended with status 3" in one["reason"] for one in found.unloaded)
    monkeypatch.setattr(plugins, "IMPORT_SECONDS", 0.1)
    (failed,) = plugins.list_plugins(settings(slow="while True: pass")).unloaded
    assert "not imported within 0.1 s" in failed["reason"]


def test_without_modules_no_process_is_started(monkeypatch):
    monkeypatch.setattr(plugins, "entry_points", lambda group: ())
    monkeypatch.setattr(plugins.processes, "run", None)
    assert plugins.list_plugins(Settings(modules="")) == plugins.PluginReport()


def test_a_changed_file_is_listed_again(settings, monkeypatch):
    chosen, asked, report = settings(mine=GOOD), Queue(), plugins.PluginReport()
    monkeypatch.setattr(plugins, "list_plugins", lambda given: asked.put(given) or report)
    watcher = plugins.PluginWatcher(chosen, 0.01)
    assert asked.get_nowait() == chosen
    plugins.files(chosen)[0].write_text(f"{GOOD}# Changed.")
    watcher.start()
    assert asked.get(timeout=10) == chosen
    watcher.end()
    watcher.join()
    assert asked.empty()


CARRY_OUT = """
import json, sys
from types import SimpleNamespace
from microcosmos_server.settings import Settings
from microcosmos_worker.evolution import carry_out

outcome = {}
for spec in json.loads(sys.argv[1]):
    attempt = SimpleNamespace(
        run_id="a",
        spec=spec,
        services=SimpleNamespace(settings=Settings()),
        record_device=lambda device, sinks: None,
        restore=lambda: None,
        initial=lambda: [],
        pause_until_resumed=lambda text: outcome.update(aside=text),
        refuse=lambda text: outcome.update(refused=text),
    )
    carry_out(attempt)
print(json.dumps(outcome))
"""


def test_a_run_on_the_wrong_worker_is_paused_or_refused(settings):
    wrong = GOOD.replace("...", "return 3")
    chosen = settings(mine=wrong)
    (stick,) = plugins.list_plugins(chosen).plugins
    spec = {"experiment": "quality-diversity", "task": {"steps": 400}}
    specs = []
    for source in ("a" * 64, stick["source"]):
        version = {"source": source, "title": "A stick"}
        specs.append({**spec, "body": {"builder": "mine.stick", "plugin": version}})
    command = [sys.executable, "-c", CARRY_OUT, json.dumps(specs)]
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, check=True)
    outcome = json.loads(done.stdout.splitlines()[-1])
    assert "must be of version aaaaaaaaaaaa, got version" in outcome["aside"]
    assert "mine.stick must return a body, got int" in outcome["refused"]
