"""Errors of fields are data: a field, a reason and a bound."""

import ast
import pickle
from pathlib import Path
from typing import Annotated

import pytest
from pydantic import BaseModel, Field, ValidationError

from microcosmos.archive.report import ENDED, FIGURES, SPECIES, curves_of, figure
from microcosmos.invalid import InvalidField
from microcosmos.spec import invalid_fields, parse

ROOT = Path(__file__).parents[2]
PARTS = ("spec", "bodies", "archive", "plugins", "exports", "study", "statistics")
SOURCES = [
    *(path for part in PARTS for path in (ROOT / "engine/microcosmos" / part).rglob("*.py")),
    *(ROOT / "server/microcosmos_server").rglob("*.py"),
]
DEMO = {"experiment": "quality-diversity"}


def errors(document):
    with pytest.raises(ValidationError) as refused:
        parse(document)
    return invalid_fields(refused.value.errors())


def test_an_error_of_a_field_and_one_between_fields_are_told_alike():
    (one,) = errors(DEMO | {"world": {"viscosity": -1}})
    assert (one.field, one.got) == ("world.viscosity", -1)
    (other,) = errors(DEMO | {"world": {"magic": "fixed", "viscosity": 0.005}})
    assert other.field == "world.magic"
    assert other.reason.startswith("must be 'capped'")
    assert str(other) == f"`world.magic` {other.reason}"


def test_an_unknown_name_of_a_part_is_told_at_the_field_that_names_it():
    assert errors(DEMO | {"body": {"builder": "snake"}})[0].field == "body.builder"


def test_a_length_is_told_in_items_and_characters():
    class Named(BaseModel):
        few: Annotated[list[int], Field(min_length=2, max_length=3)] = [1, 2]
        name: Annotated[str, Field(min_length=2, max_length=3, pattern="^a{2}")] = "aa"

    for sent, reason in (
        ({"few": [1]}, "needs 2 or more items; got [1]"),
        ({"few": [1] * 4}, "needs at most 3 items; got [1, 1, 1, 1]"),
        ({"name": "a"}, "needs 2 or more characters; got 'a'"),
        ({"name": "aaaa"}, "needs at most 3 characters; got 'aaaa'"),
        ({"name": "bbb"}, "needs a text that matches ^a{2}; got 'bbb'"),
    ):
        with pytest.raises(ValidationError) as refused:
            Named(**sent)
        (error,) = invalid_fields(refused.value.errors())
        assert error.reason == reason


def test_a_bound_is_a_number_that_the_field_accepts():
    body = {"builder": "chain", "nodes": 48}
    (one,) = errors(DEMO | {"body": body, "world": {"width": 32, "height": 40}})
    assert one.field == "world.width"
    assert one.least is not None
    assert one.least > 32
    side = int(one.least)
    parse(DEMO | {"body": body, "world": {"width": side, "height": side}})


def test_an_error_passes_between_processes():
    error = InvalidField("a.b", "must be at least 2", least=2)
    again = pickle.loads(pickle.dumps(error))
    assert (again.field, again.reason, again.least) == ("a.b", "must be at least 2", 2)


def test_an_error_that_names_a_field_has_it_as_data():
    wrong = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for path in SOURCES
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id == "ValueError"
        and node.args
        and _begins_with_a_field(node.args[0])
    ]
    assert not wrong, "raise `InvalidField`"


def _begins_with_a_field(text):
    first = text.values[0] if isinstance(text, ast.JoinedStr) and text.values else text
    return isinstance(first, ast.Constant) and str(first.value).startswith("`")


def test_a_figure_is_found_by_its_name():
    summary = {"emitter.iso+line.inserted": 3, "species.7": 4, "ended.fitness": 9}
    assert SPECIES.of(summary) == {"7": 4}
    assert ENDED.of(summary) == {"fitness": 9}
    assert curves_of(summary) == {"emitter.iso+line.inserted": 3}
    assert figure("infeasible.supersonic").adds
    assert figure("of a plug-in") is None


def test_the_document_lists_every_figure():
    document = (ROOT / "docs/api.md").read_text()
    assert not [one for one in FIGURES if f"| `{one.name}` | {one.title} |" not in document]
