"""The loop knows parts by their moments alone, and a part of one's own takes part."""

import ast
import re
from dataclasses import fields, replace
from pathlib import Path

import jax
import numpy as np
import pytest

from microcosmos import search
from microcosmos.build.parts import PARTS
from microcosmos.search import emitters, loop
from microcosmos.search.ask_tell import Results
from microcosmos.search.loop import Ask, Leaf, Part, Program, State
from microcosmos.search.parts.records import Entries, appended

SOURCES = Path(search.__file__).parents[1]
GENERAL = ("search/loop.py", "search/state_file.py", "experiments/archive_file.py")
GENERAL += ("experiments/evolution.py",)
FEATURES = {"breeding", "screening", "reevaluation", "initial", "lessons", "fronts", "epochs"}
FEATURES |= {"outcomes", "failures", "curves", "bred", "screened", "repeats", "choices"}
VECTORS = search.Vectors(genes=2)
GRID = search.Grid((search.Axis(0, -1.0, 1.0, bins=5),))


@pytest.mark.parametrize("path", GENERAL)
def test_the_loop_the_file_and_the_report_name_no_part(path):
    tree = ast.parse((SOURCES / path).read_text())
    names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    names |= {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    names |= {node.arg for node in ast.walk(tree) if isinstance(node, ast.arg | ast.keyword)}
    texts = [node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)]
    names |= {
        word for text in texts if isinstance(text, str) for word in re.findall(r"\w+", text)
    }
    assert not names & FEATURES


def test_the_state_has_few_fields_and_none_of_a_feature():
    names = {one.name for one in fields(State)}
    assert len(names) <= 12
    assert not names & FEATURES


def test_every_module_of_a_part_is_in_the_registry_of_parts():
    modules = {path.stem for path in (SOURCES / "search" / "parts").glob("[a-z]*.py")}
    registry = ast.parse((SOURCES / "build" / "parts.py").read_text())
    used = {node.id for node in ast.walk(registry) if isinstance(node, ast.Name)}
    assert modules <= used
    assert len(PARTS) >= len(modules)


class Memory(search.parts.records.Curves):
    """A row for each generation, as the curves have."""


@pytest.fixture
def loop_of():
    """A function that gives the plan of a search on vectors with some parts."""

    def plan(*parts):
        own = search.Search(VECTORS, GRID, [emitters.IsoLine(4, VECTORS, 0.1)], seed=1)
        return replace(own.plan, parts=parts)

    return plan


def answered(ask):
    """Return what a function of a vector gives for each row of a request."""
    rows = np.asarray(jax.tree.leaves(ask.rows)[0], np.float32)
    return Results(-(rows**2).sum(1), rows[:, :1], np.zeros(len(rows), np.int32))


def doubling(moments):
    """A part that evaluates every child once more after the insertion, and counts."""

    def learn(own, turn):
        moments.append("learn")
        again = yield Ask(turn.batch.children.genotypes, "again")
        row = np.array([[again.fitness.sum()]])
        return Memory(np.concatenate([own.rows, row])), turn

    def note(name):
        def act(own, turn):
            moments.append(name)
            return own, turn

        return act

    return Part(
        name="doubling",
        begin=lambda plan: Memory(np.zeros((0, 1))),
        leaves={"rows": Leaf("generation", "doubling")},
        programs={"again": Program(lambda rows: rows, block=4)},
        propose=note("propose"),
        amend=note("amend"),
        placed=note("placed"),
        learn=learn,
        figures=lambda own, turn: {"sum": float(own.rows[-1, 0])},
        asks_late=True,
    )


def test_a_part_acts_in_every_moment_and_its_requests_count(loop_of):
    moments = []
    plan = loop_of(doubling(moments))
    turn = loop.drive(loop.generation(plan, loop.start(plan)), answered)
    assert moments == ["propose", "amend", "placed", "learn"]
    assert turn.after.evaluations == 8, "children, and the same once more"
    fitness = answered(Ask(turn.batch.children.genotypes, "again")).fitness
    assert turn.figures == {"sum": pytest.approx(fitness.sum())}


def test_a_driver_that_fails_drops_the_generation(loop_of):
    plan = loop_of()
    state = loop.start(plan)

    def failing(ask):
        raise search.Stopped

    with pytest.raises(search.Stopped):
        loop.drive(loop.generation(plan, state), failing)
    one, other = (
        loop.drive(loop.generation(plan, each), answered).after
        for each in (state, loop.start(plan))
    )
    jax.tree.map(np.testing.assert_array_equal, one.elites, other.elites)


def test_an_event_for_a_part_that_the_search_lacks_is_refused(loop_of):
    plan = loop_of()
    with pytest.raises(ValueError, match="a part that receives 'weather', it has none"):
        loop.received(plan, loop.start(plan), "weather", None)


def test_entries_are_appended_with_few_copies():
    random = np.random.default_rng(0)
    sizes = random.integers(0, 60, 2_000)
    pieces, copied, end = (entries(np.arange(0)),), 0, 0
    for size in sizes.tolist():
        before = {id(one) for one in pieces}
        pieces = appended(pieces, entries(np.arange(end, end + size)))
        end += size
        copied += sum(len(one.cell) for one in pieces if id(one) not in before)
        lengths = [len(one.cell) for one in pieces]
        assert lengths == sorted(set(lengths), reverse=True)
    joined = jax.tree.map(lambda *columns: np.concatenate(columns), *pieces)
    jax.tree.map(np.testing.assert_array_equal, joined, entries(np.arange(end)))
    assert len(pieces) < 40
    assert copied < 20 * end, "copying all in each generation is a thousand times its size"


def entries(numbers):
    names = np.repeat(numbers[:, None], 32, 1).astype(np.uint8)
    return Entries(
        creature=names,
        parents=np.stack([names, names], 1),
        operator=numbers.astype(np.int32),
        generation=numbers.astype(np.int32),
        cell=numbers.astype(np.int32),
        fitness=numbers.astype(np.float32),
        descriptors=np.stack([numbers, numbers], 1).astype(np.float32),
    )
