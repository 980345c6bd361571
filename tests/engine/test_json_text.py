"""A name that stands twice in JSON is refused wherever people's files are read."""

import re

import pytest

from microcosmos.archive import creature
from microcosmos.cli.specs import value
from microcosmos.client import specs
from microcosmos.client.client import creature_file
from microcosmos.json_text import read_json
from microcosmos.study.runs import _read
from microcosmos.viz.figures.sheet import verdicts

TWICE = '{"creature": {"seed": 1, "seed": 2}, "verdict": {"trusted": true}}'
READERS = {
    "a spec": specs.read,
    "a creature": creature_file,
    "a creature's text": lambda path: creature.parse(path.read_bytes()),
    "the spec of a study": lambda path: _read(path.name, "sweeps.a", path.parent),
    "a report of an audit": lambda path: verdicts([path]),
}


@pytest.mark.fast
@pytest.mark.parametrize("reader", READERS)
def test_a_name_given_twice_is_refused_by_its_path(reader, tmp_path):
    (tmp_path / "file.json").write_text(TWICE)
    with pytest.raises(ValueError, match=r"`creature\.seed` must be given once; got it twice"):
        READERS[reader](tmp_path / "file.json")


def test_commands_refuse_it_in_a_spec_and_in_a_value(invoke, tmp_path):
    (tmp_path / "spec.json").write_text('{"world": [{"width": 1, "width": 2}]}')
    said = invoke("evolve", tmp_path / "spec.json", code=2)
    assert "`world.0.width` must be given once; got it twice" in said
    with pytest.raises(Exception, match=re.escape("`a` must be given once; got it twice")):
        value('{"a": 1, "a": 1}', "world.flow")


@pytest.mark.fast
def test_names_of_different_objects_may_be_alike():
    text = '{"a": {"b": 1}, "b": [{"b": 2}, {"b": 3}]}'
    assert read_json(text) == {"a": {"b": 1}, "b": [{"b": 2}, {"b": 3}]}


@pytest.mark.fast
def test_nesting_without_an_end_is_no_json():
    with pytest.raises(ValueError, match="nest less deeply"):
        read_json("[" * 100_000)
