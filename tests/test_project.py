"""Files that describe the project agree with each other."""

import json
import tomllib
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


def test_released_kernels_have_the_interface_that_their_project_names():
    kernel = tomllib.loads((ROOT / "engine/kernels/pyproject.toml").read_text())
    lock = (ROOT / "requirements-xla.lock").read_text()
    assert lock.split()[0] in kernel["build-system"]["requires"]


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
