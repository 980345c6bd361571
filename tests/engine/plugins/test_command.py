"""Plug-in modules on the command line."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from microcosmos.cli import app
from microcosmos.plugins import registry

pytestmark = pytest.mark.fast

EXAMPLE = str(Path(__file__).parents[3] / "examples" / "plugin_task.py")


@pytest.fixture(autouse=True)
def none_before(monkeypatch):
    monkeypatch.setattr(registry, "_plugins", {})


def ran(*arguments, code=0):
    done = CliRunner().invoke(app, list(map(str, arguments)))
    assert done.exit_code == code, done.output
    return " ".join(done.output.split())


def test_what_a_module_adds_is_listed_with_its_version():
    text = ran("plugins", "--module", EXAMPLE)
    assert "plugin_task.straight fitness Straight way in cells (" in text
    assert "plugin_task.cross body A cross (" in text


@pytest.mark.parametrize("command", ["evolve", "replay", "audit", "refine", "gradient"])
def test_a_module_that_is_none_ends_a_command_with_the_reason(command, tmp_path):
    (tmp_path / "file.json").write_text("{}")
    (tmp_path / "bad.py").write_text("1 / 0")
    text = ran(command, tmp_path / "file.json", "--module", tmp_path / "bad.py", code=2)
    assert "ZeroDivisionError: division by zero" in text


def test_a_spec_that_needs_a_module_says_which_option_gives_it(tmp_path):
    spec = {"experiment": "quality-diversity", "task": {"fitness": "plugin_task.straight"}}
    (tmp_path / "spec.json").write_text(json.dumps(spec))
    text = ran("evolve", tmp_path / "spec.json", code=2)
    assert "`fitness` must be known, got 'plugin_task.straight': none is loaded" in text
    assert "--module" in text
