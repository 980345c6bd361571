"""Emitters as plug-ins: in specs, in runs that are killed and go on, and what is refused."""

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from microcosmos import plugins
from microcosmos.archive import creature, file
from microcosmos.build import build
from microcosmos.operators import OPERATORS
from microcosmos.plugins import registry
from microcosmos.search.parts.breeding import BRED
from microcosmos.spec import breeding_refusal, parse, plugins_in

EXAMPLE = Path(__file__).parents[3] / "examples" / "plugin_emitter.py"
FIFTH = {"operator": "plugin_emitter.fifth", "plugin": {"settings": {"first": 0.2}}}
SPEC = {
    "experiment": "quality-diversity",
    "world": {"width": 24, "height": 24},
    "body": {"nodes": 8},
    "control": {"encoding": "direct", "period": 20},
    "task": {"steps": 20, "fitness": "displacement"},
    "search": {
        "feasible": False,
        "generations": 4,
        "batch": 8,
        "block": 4,
        "emitters": [{"operator": "iso+line"}, FIFTH],
    },
}
BROKEN = """
from dataclasses import dataclass
from microcosmos import plugins
from microcosmos.search import emitters

@plugins.emitter("nothing", title="No emitter")
def nothing(problem):
    return problem

@plugins.emitter("short", title="Too few offspring")
def short(problem):
    return emitters.Random(problem.slots - 1, problem.newcomer)

@plugins.emitter("secret", title="Has a state that it does not declare")
def secret(problem):
    return emitters.CmaMae(problem.slots, problem.newcomer, problem.cells.count, 0.2, 0.01, 0.0)

@plugins.emitter("sloping", title="Has no gradients", gradients=1, learns="offspring")
def sloping(problem):
    return emitters.Random(problem.slots, problem.newcomer)

@plugins.emitter("plain", title="Random")
def plain(problem):
    return emitters.Random(problem.slots, problem.newcomer)
"""
NAMES = """
from dataclasses import dataclass
from typing import Any
import equinox as eqx
import jax.numpy as jnp
from microcosmos import plugins
from microcosmos.genomes import Vector
from microcosmos.search import emitters

@dataclass(frozen=True)
class Chosen(emitters.Stateless):
    slots: int
    newcomer: Any
    select: int

    def emit(self, state, archive, *, keys):
        genes = emitters.newcomers(self.newcomer, keys).genotypes.values
        genes = jnp.zeros_like(genes).at[:, self.select].set(genes[:, self.select])
        return emitters.parentless(Vector(genes), self.slots, "random"), None, None

@plugins.emitter("select", title="Newcomers with one gene")
def select(problem):
    return Chosen(problem.slots, problem.newcomer, 3)

class Sized(eqx.Module):
    sizes: Any

@dataclass(frozen=True)
class Sizes:
    slots: int
    newcomer: Any

    def init(self, *, key):
        return Sized(jnp.zeros(2))

    def emit(self, state, archive, *, keys):
        return emitters.newcomers(self.newcomer, keys), state, None

    def tell(self, state, outcome):
        return Sized(state.sizes + 1)

@plugins.emitter("sizes", title="Newcomers, counted", learns="offspring")
def sizes(problem):
    return Sizes(problem.slots, problem.newcomer)
"""
"""Emitters whose fields have the names of those of others."""


@pytest.fixture(autouse=True)
def loaded(monkeypatch):
    monkeypatch.setattr(registry, "_plugins", {})
    return plugins.load(EXAMPLE)


@pytest.fixture(scope="module")
def course(carry_out):
    before, registry._plugins = registry._plugins, {}
    plugins.load(EXAMPLE)
    experiment = build(parse(SPEC))
    states, reports = carry_out(experiment)
    registry._plugins = before
    return experiment, states, reports


def with_emitters(*emitters, **search):
    return parse(SPEC | {"search": SPEC["search"] | search | {"emitters": list(emitters)}})


@pytest.mark.fast
def test_a_spec_holds_version_settings_and_facts_of_an_emitter(loaded, monkeypatch):
    document = parse(SPEC).model_dump(mode="json")
    (used,) = plugins_in(document)
    assert used.path == "search.emitters.1.operator"
    assert used.version.source == loaded[0].source
    emitter = document["search"]["emitters"][1]
    assert emitter["plugin"]["settings"] == {"first": 0.2, "factor": 1.1}
    facts = {"varies": ["numbers"], "learns": "offspring", "gradients": 0}
    assert emitter["plugin"]["emits"] == facts
    assert "learns from all of its offspring" in str(breeding_refusal(document))
    monkeypatch.setattr(registry, "_plugins", {})
    assert parse(document).model_dump(mode="json") == document, "read without the module"
    with pytest.raises(plugins.Missing, match=r"plugin_emitter\.fifth .* is not loaded here"):
        build(parse(document))


@pytest.mark.fast
@pytest.mark.parametrize(
    ("part", "value", "words"),
    [
        ("control", {"encoding": "cppn"}, "is 'cppn', got 'plugin_emitter.fifth'"),
        ("search", {"emitters": [FIFTH], "screening": {}}, "which learns from all of its"),
        (
            "search",
            {"emitters": [{"operator": "plugin_emitter.other"}]},
            "must be known",
        ),
        (
            "search",
            {"emitters": [FIFTH | {"plugin": {"settings": {"first": 7}}}]},
            "`plugin.settings.first` needs",
        ),
    ],
)
def test_a_spec_that_an_emitter_does_not_fit_is_refused(part, value, words):
    with pytest.raises(ValidationError) as refused:
        parse({**SPEC, "search": {"emitters": [FIFTH]}, part: value})
    assert words in str(refused.value)


def test_its_operator_has_a_name_in_the_file_and_in_creatures(course):
    experiment, states, reports = course
    tree, attributes = file.load(experiment.save(states[-1]))
    names = json.loads(attributes["operators"])
    assert names == [*OPERATORS, "plugin_emitter.fifth"]
    assert names.index("plugin_emitter.fifth") in tree["lineage"]["operator"]
    cell = int(np.flatnonzero(states[-1].parts["lineage"].operators == len(OPERATORS))[0])
    found = creature.parse(experiment.creature(states[-1], cell))
    assert found["provenance"]["operator"] == "plugin_emitter.fifth"
    assert len(found["provenance"]["parents"]) == 1
    assert "emitter.plugin_emitter.fifth.inserted" in reports[-1].summary


def test_it_learns_from_its_own_offspring(course):
    """More than a fifth of them enter, or not: the step follows."""
    _, states, _ = course
    for before, after in pairwise(states):
        _, inserted, improved = after.parts["outcomes"].counts[-1, 1].tolist()
        factor = 1.1 if (inserted + improved) / 4 > 0.2 else 1 / 1.1
        size = np.float32(before.emitters[1].size) * np.float32(factor)
        np.testing.assert_allclose(after.emitters[1].size, size, rtol=1e-6)


@pytest.mark.long
def test_a_run_goes_on_from_any_file_with_the_same_bytes(course):
    experiment, states, _ = course
    files = [experiment.save(state) for state in states]
    for before, after in pairwise(files):
        taken_up = experiment.restore(before)
        assert experiment.save(taken_up) == before
        assert experiment.save(experiment.advance(taken_up)[0]) == after


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("nothing", "must return an emitter, got Problem"),
        ("short", "must have 8 `slots`, got 7"),
        ("secret", "must be a dataclass without a state, or declare what it `learns`"),
        ("sloping", "must declare `gradients` if it learns by them, only then"),
    ],
)
def test_an_emitter_that_is_not_as_declared_is_refused_by_name(name, words, tmp_path):
    (tmp_path / "faulty.py").write_text(BROKEN)
    plugins.load(tmp_path / "faulty.py")
    with pytest.raises(plugins.Broken, match=rf"faulty\.{name} {words}"):
        build(with_emitters({"operator": f"faulty.{name}"}))


def test_one_that_learns_nothing_may_be_screened_and_stand_beside_breeding(tmp_path):
    (tmp_path / "faulty.py").write_text(BROKEN)
    plugins.load(tmp_path / "faulty.py")
    emitters = {"operator": "faulty.plain"}, {"operator": "gaussian"}
    chosen = with_emitters(*emitters, screening={"rounds": 1, "candidates": 2})
    assert breeding_refusal(chosen.model_dump(mode="json")) is None
    assert build(chosen).plan.names == ("faulty.plain", "gaussian")


@pytest.fixture
def names(tmp_path):
    (tmp_path / "names.py").write_text(NAMES)
    plugins.load(tmp_path / "names.py")


@pytest.mark.long
def test_its_slots_are_left_to_built_in_emitters_where_creatures_are_chosen(names):
    experiment = build(with_emitters({"operator": "names.select"}, {"operator": "gaussian"}))
    state, _ = experiment.advance(experiment.init())
    cell = int(np.flatnonzero(state.elites.occupied)[0])
    chosen = experiment.receive(state, "breeding", [experiment.creature(state, cell)])
    batch = experiment.propose(chosen)
    bred = batch.emitter == BRED
    assert bred.sum() == 4
    operators = np.asarray(batch.children.operator)[bred]
    assert set(operators) == {OPERATORS.index("gaussian")}


def test_its_state_may_have_fields_of_any_name(names):
    experiment = build(with_emitters({"operator": "names.sizes"}))
    state, report = experiment.advance(experiment.init())
    np.testing.assert_array_equal(state.emitters[0].sizes, 1)
    assert not [name for name in report.summary if name.startswith("species")]
