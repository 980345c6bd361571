"""Plug-ins of a worker: listed in another process, again when a file changes."""

import json
import subprocess
import sys
import time
from hashlib import sha256
from pathlib import Path
from queue import Queue
from types import SimpleNamespace

import pytest

from microcosmos_server.settings import Settings
from microcosmos_server.tables import Worker
from microcosmos_worker import jobs, plugins, supervisor
from microcosmos_worker.device import Device
from microcosmos_worker.heartbeats import Heartbeats
from microcosmos_worker.readiness import Readiness
from microcosmos_worker.supervisor import Supervisor

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


def test_a_worker_takes_no_run_until_it_has_reported_the_files_as_they_are(
    services, settings, run_id, monkeypatch
):
    """Runs of the version before would be paused, and wait for a person."""
    chosen = settings(mine=GOOD)
    watcher = plugins.PluginWatcher(chosen, interval=1000)
    device = Device("a processor", 8 << 30, {})
    beats = Heartbeats(services.sessions, "worker", device, 20, plugins=watcher)
    busy = Supervisor(services, "worker", {}, beats, Readiness(services, device), watcher)
    monkeypatch.setattr(busy.readiness, "check", lambda: True)
    monkeypatch.setattr(supervisor, "PAUSE_SECONDS", 0.01)
    listed, taken = [], []

    def versions():
        with services.sessions.read() as session:
            return [one["source"] for one in session.get_one(Worker, "worker").plugins]

    def carry_out(run):
        taken.append(run)
        listed.append(versions())
        monkeypatch.setattr(supervisor, "stop_requested", lambda: True)

    monkeypatch.setattr(busy, "carry_out", carry_out)
    beats.beat()
    before = versions()
    plugins.files(chosen)[0].write_text(f"{GOOD}# Changed.")
    watcher.start()
    beats.start()
    try:
        busy.serve()
    finally:
        watcher.end()
        beats.end()
    assert taken == [run_id]
    assert listed == [[sha256(f"{GOOD}# Changed.".encode()).hexdigest()]] != [before]


def test_a_renderer_loads_a_changed_file(settings, monkeypatch):
    chosen = settings(mine=GOOD)
    monkeypatch.setattr(jobs, "services", lambda: SimpleNamespace(settings=chosen))
    monkeypatch.setattr(jobs, "_loaded", None)
    loaded = []
    monkeypatch.setattr(
        plugins, "load", lambda _: loaded.append(plugins.files(chosen)[0].read_text())
    )
    monkeypatch.setattr("microcosmos.device.prepare", lambda: loaded.append("device"))
    for text in (GOOD, f"{GOOD}# Changed."):
        plugins.files(chosen)[0].write_text(text)
        jobs.prepare_job()
        jobs.prepare_job()
    assert loaded == ["device", GOOD, f"{GOOD}# Changed."]


def test_a_listing_that_fails_is_tried_again(settings, monkeypatch):
    """A process cannot start while there is no memory; importing may take too long once."""
    chosen, outcomes = settings(mine=GOOD), Queue()
    failed = plugins.PluginReport(is_complete=False)

    def listing(_):
        outcome = outcomes.get_nowait()
        if isinstance(outcome, Exception):
            raise outcome
        return outcome

    monkeypatch.setattr(plugins, "list_plugins", listing)
    monkeypatch.setattr(plugins, "AGAIN_SECONDS", 0.02)
    for outcome in (failed, OSError("no memory"), plugins.PluginReport()):
        outcomes.put(outcome)
    watcher = plugins.PluginWatcher(chosen, 0.01)
    watcher.start()
    end = time.monotonic() + 10
    while not watcher.report.is_complete and time.monotonic() < end:
        time.sleep(0.01)
    watcher.end()
    watcher.join()
    assert watcher.report.is_complete
    assert outcomes.empty()


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
        listed_plugins=lambda: json.loads(sys.argv[2]),
        requeue=lambda: outcome.update(queued=True),
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
    outcome = outcome_of(specs, [stick])
    assert "queued" not in outcome
    assert "must be of version aaaaaaaaaaaa, got version" in outcome["aside"]
    assert "mine.stick must return a body, got int" in outcome["refused"]


def test_a_run_whose_plug_in_was_edited_a_moment_ago_waits(settings):
    """It waits for a worker with its version, as if it had not been taken."""
    (stick,) = plugins.list_plugins(settings(mine=GOOD)).plugins
    version = {"source": stick["source"], "title": "A stick"}
    body = {"builder": "mine.stick", "plugin": version}
    spec = {"experiment": "quality-diversity", "task": {"steps": 400}, "body": body}
    settings(mine=f"{GOOD}# Changed.")
    assert outcome_of([spec], [stick]) == {"queued": True}
    # A file that is as it was listed, and does not load, is nothing to wait for.
    changed = {**stick, "source": sha256(f"{GOOD}# Changed.".encode()).hexdigest()}
    assert "must be of version" in outcome_of([spec], [changed])["aside"]
    # What comes from an installed package is never listed anew.
    other = {**stick, "name": "package.stick"}
    assert "must be of version" in outcome_of([spec], [other])["aside"]


def outcome_of(specs, listed):
    """Carry out runs on a worker that has listed plug-ins, and return what it did with them."""
    command = [sys.executable, "-c", CARRY_OUT, json.dumps(specs), json.dumps(listed)]
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, check=True)
    return json.loads(done.stdout.splitlines()[-1])
