"""Plug-in modules: declarations, errors and commands."""

import importlib.util
import json
import os
import re
import sys
from hashlib import sha256
from pathlib import Path
from types import SimpleNamespace

import pytest

from microcosmos import plugins
from microcosmos.plugins import loading, registry

pytestmark = pytest.mark.fast

HEAD = "from microcosmos import plugins\nfrom microcosmos.spec import Part\n"
BODY = f"{HEAD}class S(Part):\n    a: int\n"
BODY += '@plugins.body("b", title="B", nodes=3, settings={})\ndef b(s): ...'
ONE = HEAD + '@plugins.fitness("far", title="Far")\ndef far(motion):\n    return motion\n'


@pytest.fixture(autouse=True)
def none_before(monkeypatch):
    monkeypatch.setattr(registry, "_plugins", {})


@pytest.fixture
def write(tmp_path):
    def write(text, name="mine.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
        return tmp_path / name

    return write


def test_a_file_is_loaded_under_its_name_with_its_hash(write):
    file = write(ONE)
    (one,) = plugins.load(file)
    assert (one.kind, one.name, one.title) == ("fitness", "mine.far", "Far")
    assert one.source == sha256(file.read_bytes()).hexdigest()
    assert plugins.find(("fitness",), "mine.far", one.source)(7, settings={}) == 7


def test_a_file_that_is_loaded_again_takes_the_place_of_what_it_was(write):
    (first,) = plugins.load(write(ONE))
    (second,) = plugins.load(write(ONE.replace("far", "near")))
    assert [one.declaration for one in plugins.loaded()] == [second]
    with pytest.raises(plugins.Missing, match="--module"):
        plugins.find(("fitness",), "mine.far", first.source)
    (third,) = plugins.load(write(ONE + "# Changed.\n"))
    expected = f"{first.source[:12]}, got version {third.source[:12]}"
    with pytest.raises(plugins.Missing, match=expected):
        plugins.find(("fitness",), "mine.far", first.source)


def test_a_module_changed_within_a_second_is_loaded_anew(write, monkeypatch):
    """Python would take what it compiled of a file of the same size and second."""
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    for value in ("1", "2"):
        file = write(ONE.replace("return motion", f"return {value}"))
        os.utime(file, (1e9, 1e9))
        (one,) = plugins.load(file)
        assert one.source == sha256(file.read_bytes()).hexdigest()
        assert plugins.find(("fitness",), "mine.far", one.source)(7, settings={}) == int(value)
    assert [path.name for path in file.parent.iterdir()] == ["mine.py"]


def test_a_file_that_broke_leaves_what_was_loaded_of_it(write):
    (one,) = plugins.load(write(ONE))
    before = sys.modules["microcosmos_plugin_mine"]
    file = write(ONE + "1 / 0\n")
    with pytest.raises(ValueError, match=r"mine\.py, line 6 fails with ZeroDivisionError"):
        plugins.load(file)
    assert [plugin.declaration for plugin in plugins.loaded()] == [one]
    assert sys.modules["microcosmos_plugin_mine"] is before


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "declares nothing"),
        ("1 / 0", "ZeroDivisionError: division by zero"),
        ("import sys; sys.exit(3)", "SystemExit: 3"),
        ("def (", "SyntaxError"),
        (ONE + ONE.replace("def far", "def other"), "'mine.far' more than once"),
        (ONE.replace('"far"', '"Far!"'), "`name` must be of a-z, 0-9 and _, got 'Far!'"),
        (ONE.replace("motion)", ")"), "'far' must take 1 arguments"),
        (BODY.format("S"), "must all have defaults, got none for a"),
        (BODY.format("dict"), "must be a `microcosmos.spec.Part`"),
        (
            HEAD + '@plugins.descriptor("d", title="D", low=0, high=1, scale="log10")\n'
            "def d(m): ...",
            "`low` must be above 0 where `scale` is log10, got 0",
        ),
        (HEAD + '@plugins.encoding("e", title="E")\ndef e(g, c): ...', "must be at least 1"),
    ],
)  # fmt: skip
def test_a_module_with_a_mistake_is_reported_and_others_load(write, text, words):
    file = write(text)
    with pytest.raises(ValueError, match=re.escape(words)):
        plugins.load(file)
    good = write(ONE, "good.py")
    (failed,) = plugins.load_all([file, good])
    assert (failed.module, words in failed.reason) == (str(file), True)
    assert [one.declaration.name for one in plugins.loaded()] == ["good.far"]


def test_two_modules_of_one_name_are_refused(write):
    plugins.load(write(ONE))
    with pytest.raises(ValueError, match="two modules are called 'mine'"):
        plugins.load(write(ONE, "other/mine.py"))


def test_an_installed_package_names_its_module_and_all_its_files_count(write, monkeypatch):
    found = importlib.util.spec_from_file_location("swim", write(ONE, "swim/__init__.py"))
    write("x = 1", "swim/part.py")

    def entry():
        module = importlib.util.module_from_spec(found)
        monkeypatch.setitem(sys.modules, "swim", module)
        found.loader.exec_module(module)
        return module

    entries = [SimpleNamespace(name="swim", value="swim", load=entry)]
    broken = SimpleNamespace(name="bad", value="bad", load=lambda: 1 / 0)
    monkeypatch.setattr(loading, "entry_points", lambda group: [broken, *entries])
    (failed,) = plugins.load_all([])
    assert failed.module == "bad (bad)"
    assert failed.reason == "ZeroDivisionError: division by zero"
    (one,) = plugins.loaded()
    assert one.declaration.name == "swim.far"
    write("x = 2", "swim/part.py")
    plugins.load_all([])
    assert plugins.loaded()[0].declaration.source != one.declaration.source


SET = HEAD + "from collections.abc import Callable\nfrom pydantic import Field\n"
SET += "def boom(): raise KeyError('boom')\nclass S(Part):\n    a: {}\n"
SET += '@plugins.fitness("f", title="F", settings=S)\ndef f(motion, settings): ...'


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (SET.format("Callable = print"), "mine.py fails with PydanticInvalidForJsonSchema: "),
        (SET.format("int = Field(default_factory=boom)"), "line 5 fails with KeyError: 'boom'"),
        (SET.format("float = float('nan')"), "fails with ValidationError: `a` needs a finite"),
        (ONE.replace("Far", ""), "fails with ValidationError: `title` needs"),
        (
            ONE + "class Lazy:\n    def __getattr__(self, name): raise OSError('away')\n"
            "lazy = Lazy()\n",
            "mine.py, line 7 fails with OSError: away",
        ),
        (
            "class Odd(Exception):\n    def __str__(self): return 1 / 0\nraise Odd",
            "line 3 fails with Odd: an error without a text",
        ),
    ],
)  # fmt: skip
def test_a_module_whose_code_fails_later_is_named_and_leaves_nothing(
    write, text, words, monkeypatch
):
    monkeypatch.delitem(sys.modules, "microcosmos_plugin_mine", raising=False)
    with pytest.raises(ValueError, match=re.escape(words)):
        plugins.load(write(text))
    assert "microcosmos_plugin_mine" not in sys.modules
    assert plugins.loaded() == ()


def test_an_object_that_cannot_be_hashed_is_a_plug_in(write):
    text = "from dataclasses import dataclass\n@dataclass\nclass Far:\n    by: float\n"
    text += "    def __call__(self, motion): return self.by * motion\n"
    text += 'far = plugins.fitness("far", title="Far")(Far(2.0))\n'
    (one,) = plugins.load(write(HEAD + text))
    assert plugins.find(("fitness",), "mine.far", one.source)(7, settings={}) == 14.0


EXAMPLE = str(Path(__file__).parents[3] / "examples" / "plugin_task.py")


def test_the_declarations_of_a_module_are_listed_with_its_version(invoke):
    text = invoke("plugins", "--module", EXAMPLE)
    assert "plugin_task.straight fitness Straight way in cells (" in text
    assert "plugin_task.cross body A cross (" in text


@pytest.mark.parametrize("command", ["evolve", "replay", "audit", "refine", "gradient"])
def test_a_module_that_is_none_ends_a_command_with_the_reason(command, invoke, tmp_path):
    (tmp_path / "file.json").write_text("{}")
    (tmp_path / "bad.py").write_text("1 / 0")
    text = invoke(command, tmp_path / "file.json", "--module", tmp_path / "bad.py", code=2)
    assert "ZeroDivisionError: division by zero" in text


def test_a_spec_that_needs_a_module_says_which_option_gives_it(invoke, tmp_path):
    spec = {"experiment": "quality-diversity", "task": {"fitness": "plugin_task.straight"}}
    (tmp_path / "spec.json").write_text(json.dumps(spec))
    text = invoke("evolve", tmp_path / "spec.json", code=2)
    assert "`task.fitness` must be known, got 'plugin_task.straight': none is loaded" in text
    assert "--module" in text
