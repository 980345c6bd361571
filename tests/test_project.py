"""Files that describe the project agree with each other."""

import json
import os
import signal
import subprocess
import sys
import tomllib
from importlib import import_module
from pathlib import Path

import pytest
import yaml

from microcosmos.version import VERSION

ROOT = Path(__file__).parents[1]


def test_every_file_has_the_version_of_the_library():
    package = json.loads((ROOT / "web/package.json").read_text())
    lock = json.loads((ROOT / "web/package-lock.json").read_text())
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    document = json.loads((ROOT / "web/openapi.json").read_text())
    kernel = tomllib.loads((ROOT / "engine/kernels/pyproject.toml").read_text())["project"]
    versions = [kernel, package, lock, lock["packages"][""], citation, document["info"]]
    assert {one["version"] for one in versions} == {VERSION}
    assert f"## {VERSION}" in (ROOT / "CHANGELOG.md").read_text()


def test_the_workflow_runs_what_a_contributor_can_run():
    workflow = yaml.safe_load((ROOT / ".github/workflows/ci.yml").read_text())
    steps = [step.get("run") for job in workflow["jobs"].values() for step in job["steps"]]
    assert ".ci/run" in steps
    assert (ROOT / ".ci/run").is_file()


@pytest.mark.parametrize("path", sorted(ROOT.glob("requirements*.lock")), ids=lambda p: p.name)
def test_lock_files_have_hashes_and_no_address(path):
    text = path.read_text()
    requirements = [line for line in text.splitlines() if line[:1].isalnum()]
    assert requirements
    assert all("==" in line and line.endswith("\\") for line in requirements)
    assert "://" not in text


def pins(name: str) -> dict[tuple[str, str], str]:
    """The version of each package and condition, as "python_version < '3.12'", in a lock."""
    found = {}
    for line in (ROOT / f"{name}.lock").read_text().splitlines():
        if line[:1].isalnum():
            pin, _, condition = line.rstrip("\\ ").partition(" ; ")
            package, _, version = pin.partition("==")
            found[package, condition] = version
    return found


@pytest.mark.parametrize("name", ["requirements-lab", "requirements-peers"])
def test_lock_files_that_are_installed_together_name_the_same_versions(name):
    installed, more = pins("requirements"), pins(name)
    common = installed.keys() & more.keys()
    assert common
    assert {one: more[one] for one in common} == {one: installed[one] for one in common}


def test_released_kernels_have_the_interface_that_their_project_names():
    kernel = tomllib.loads((ROOT / "engine/kernels/pyproject.toml").read_text())
    lock = (ROOT / "requirements-xla.lock").read_text()
    assert lock.split()[0] in kernel["build-system"]["requires"]


@pytest.mark.parametrize("works", [True, False])
def test_a_kernel_that_cannot_be_built_leaves_no_older_one(
    works, tmp_path, monkeypatch, capsys
):
    monkeypatch.syspath_prepend(ROOT / "engine" / "kernels")
    install, calls = import_module("install"), []
    monkeypatch.setattr(install, "system_compiler", lambda: "c++")
    monkeypatch.setattr(install, "build", lambda _: works)
    monkeypatch.setattr(install.subprocess, "run", calls.append)
    install.main(str(tmp_path / "stamp"))
    assert (tmp_path / "stamp").exists() == works
    assert ["uninstall" in call for call in calls] == ([] if works else [True])
    assert ("SKIPPED" in capsys.readouterr().out) != works


@pytest.mark.parametrize(
    "path", sorted((ROOT / ".github").rglob("*.yml")), ids=lambda p: p.name
)
def test_templates_are_valid_yaml(path):
    assert isinstance(yaml.safe_load(path.read_text()), dict)


def test_the_glossary_has_one_paragraph_for_each_term_in_order():
    """The page reads it as text: see web/src/ui/Term.tsx."""
    text = (ROOT / "docs/glossary.md").read_text()
    terms = []
    for entry in text.split("\n## ")[1:]:
        term, *paragraphs = entry.strip().split("\n\n")
        assert len(paragraphs) == 1, term
        terms.append(term.lower())
    assert terms == sorted(set(terms))
    assert {"archive", "descriptor", "elite", "feasible", "measure", "stroke"} <= set(terms)


@pytest.mark.parametrize("module", ["microcosmos", "microcosmos_server.local"])
def test_ctrl_c_ends_a_command_that_still_loads_without_a_traceback(module, tmp_path):
    press = "import os, signal, time; os.kill(os.getpid(), signal.SIGINT); time.sleep(60)"
    (tmp_path / "pydantic.py").write_text(press)
    environment = os.environ | {"PYTHONPATH": str(tmp_path), "MICROCOSMOS_DATA": str(tmp_path)}
    # Whoever starts the tests in the background ignores the signal.
    command = ["env", "--default-signal=INT", sys.executable, "-m", module, "--help"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (-signal.SIGINT, "", "")
