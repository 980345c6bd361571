"""Fitnesses, descriptors, bodies, gaits and encodings as plug-ins, in specs and in runs."""

import json

import jax
import numpy as np
import pytest
from pydantic import ValidationError

from microcosmos import plugins
from microcosmos.archive import creature, creature_h5
from microcosmos.archive.initial import fitting
from microcosmos.audit.reproducibility import check
from microcosmos.build import build
from microcosmos.build.experiments import is_portable
from microcosmos.plugins import registry
from microcosmos.spec import estimate, parse, plugins_in
from microcosmos.spec.evolution import UNLIMITED
from microcosmos.viz.replay import record
from microcosmos.viz.replay_file import read_replay

MODULE = """
from dataclasses import replace
import jax.numpy as jnp
import numpy as np
from pydantic import Field
from microcosmos import bodies, plugins
from microcosmos.bodies import swimmers
from microcosmos.spec import Part

class Strict(Part):
    strictness: float = Field(default=1.0, ge=0, le=10)

@plugins.fitness("straight", title="Straight way", unit="cells", settings=Strict)
def straight(motion, settings):
    return motion.measures["displacement"] * settings.strictness

@plugins.descriptor("ahead", title="Ahead", low=-2, high=2, unit="cells")
def ahead(motion):
    return motion.path[-1, 0] - motion.path[0, 0]

@plugins.descriptor("broken", title="Broken", low=0, high=1)
def broken(motion):
    return motion.path

@plugins.descriptor("misspelt", title="Misspelt", low=0, high=1)
def misspelt(motion):
    return motion.headings[-1]

@plugins.body("stick", title="A stick", nodes=10)
def stick():
    return bodies.chain(8, 1.0)

@plugins.body("large", title="Larger than it says", nodes=3)
def large():
    return bodies.chain(8, 1.0)

@plugins.body("uneven", title="Stiffer at one end", nodes=8)
def uneven():
    body = bodies.chain(8, 1.0)
    return replace(body, bend=np.linspace(0.1, 1, len(body.bend)))

@plugins.gait("wiggler", title="A wiggler", nodes=8)
def wiggler():
    body = bodies.chain(8, 1.0)
    def gait(time):
        wave = np.sin(2 * np.pi * (np.linspace(0, 1, 6)[None] - time[:, None]))
        return 0.3 * wave, np.zeros((len(time), 7))
    return swimmers.Swimmer("wiggler", body, gait)

@plugins.encoding("pulse", title="A pulse", genes=2, per_joint=1, settings=Strict)
def pulse(genes, clock, settings):
    wave = jnp.sin(clock.phase[:, None] + 3 * genes[0] * clock.joints[None])
    return wave * genes[None, 2:], 0.1 * jnp.cos(clock.phase)[:, None] * clock.edges[None]
"""

SPEC = {
    "experiment": "quality-diversity",
    "world": {"width": 24, "height": 24},
    "body": {"builder": "extra.stick"},
    "control": {"encoding": "extra.pulse", "period": 20, "angle_scale": 0.5} | UNLIMITED,
    "task": {
        "fitness": "extra.straight",
        "plugin": {"settings": {"strictness": 2}},
        "steps": 20,
    },
    "archive": {
        "descriptors": [{"name": "extra.ahead", "bins": 8}, {"name": "displacement", "bins": 4}]
    },
    "search": {
        "feasible": False,
        "generations": 2,
        "batch": 4,
        "block": 4,
        "emitters": [{"operator": "gaussian"}],
    },
}

PLAIN = SPEC | {
    "body": {"nodes": 8},
    "control": {"encoding": "direct", "period": 20},
    "task": {"fitness": "displacement", "steps": 20},
    "archive": {"descriptors": [{"name": "displacement", "bins": 4}]},
}
"""The spec without plug-ins."""


@pytest.fixture(scope="module")
def module(tmp_path_factory):
    file = tmp_path_factory.mktemp("plugins") / "extra.py"
    file.write_text(MODULE)
    return file


@pytest.fixture(autouse=True)
def loaded(module, monkeypatch):
    monkeypatch.setattr(registry, "_plugins", {})
    return plugins.load(module)


@pytest.fixture
def away(monkeypatch):
    return lambda: monkeypatch.setattr(registry, "_plugins", {})


@pytest.fixture(scope="module")
def course(module, carry_out):
    before, registry._plugins = registry._plugins, {}
    plugins.load(module)
    experiment = build(parse(SPEC))
    states, reports = carry_out(experiment)
    registry._plugins = before
    return experiment, states[-1], reports


def test_a_spec_says_the_version_and_all_settings_of_what_it_names(loaded):
    document = parse(SPEC).model_dump(mode="json")
    named = {one.path: one.name for one in plugins_in(document)}
    assert named == {
        "task.fitness": "extra.straight",
        "body.builder": "extra.stick",
        "control.encoding": "extra.pulse",
        "archive.descriptors.0.name": "extra.ahead",
    }
    assert {one.version.source for one in plugins_in(document)} == {loaded[0].source}
    assert document["task"]["plugin"]["settings"] == {"strictness": 2.0}
    axis = document["archive"]["descriptors"][0]
    assert (axis["low"], axis["high"], axis["scale"]) == (-2, 2, "linear")


@pytest.mark.fast
def test_a_spec_can_be_read_without_its_module(away):
    chosen = parse(SPEC)
    away()
    again = parse(chosen.model_dump(mode="json"))
    assert again == chosen
    assert estimate(again).memory_bytes > 0
    with pytest.raises(plugins.Missing, match=r"extra\.stick .* is not loaded here: give its"):
        build(again)


@pytest.mark.fast
@pytest.mark.parametrize(
    ("part", "value", "words"),
    [
        ("task", {"fitness": "extra.nothing"}, "`fitness` must be known, got 'extra.nothing'"),
        ("task", {"fitness": "extra.ahead"}, "loaded are extra.straight"),
        ("task", {"fitness": "os.system"}, "give its module with --module"),
        (
            "task",
            {"fitness": "extra.straight", "plugin": {"settings": {"strictness": -1}}},
            "`plugin.settings.strictness` needs greater than or equal",
        ),
        ("task", {"plugin": {"settings": {}}}, "must be left out where `fitness` is None"),
        ("body", {"builder": "extra.large"}, "at most the 3 `nodes` that it declares, got 8"),
        ("body", {"builder": "extra.uneven"}, "equally stiff in bend everywhere"),
        ("control", {"encoding": "extra.stick"}, "`encoding` must be known"),
    ],
)
def test_a_spec_that_does_not_fit_its_module_is_refused(part, value, words):
    with pytest.raises(ValidationError) as refused:
        parse({**SPEC, part: value})
    assert words in str(refused.value)


@pytest.mark.fast
@pytest.mark.parametrize("part", ["body", "control", "task", "archive"])
def test_a_search_with_any_plugin_promises_no_bits_of_another_processor(part):
    assert is_portable(parse(PLAIN))
    assert not is_portable(parse(PLAIN | {part: SPEC[part]}))


def test_a_run_measures_selects_and_moves_as_the_module_says(course):
    experiment, state, reports = course
    names = list(experiment.plan.measures)
    assert names[-2:] == ["extra.ahead", "extra.straight"]
    elites = jax.device_get(state.elites)
    rows, fitness = elites.measures[elites.occupied], elites.fitness[elites.occupied]
    np.testing.assert_allclose(fitness, 2 * rows[:, names.index("displacement")], rtol=1e-6)
    np.testing.assert_array_equal(fitness, rows[:, names.index("extra.straight")])
    assert np.all(np.abs(rows[:, -2]) <= rows[:, names.index("displacement")] + 1e-6)
    assert len(np.unique(fitness)) > 1
    for elite in reports[0].elites:
        assert elite.descriptors[0] == elite.measures["extra.ahead"]


def test_a_run_goes_on_from_its_file_with_the_same_bytes(course, module, away):
    experiment, state, _ = course
    data = experiment.save(state)
    first, _ = experiment.advance(experiment.init())
    middle = experiment.restore(experiment.save(first))
    assert experiment.save(experiment.advance(middle)[0]) == data
    module.write_text(MODULE + "# Changed.\n")
    away()
    plugins.load(module)
    changed = build(parse(SPEC))
    module.write_text(MODULE)
    reason = r"plugin\.source` must be \w{12}, .* continue with that version"
    with pytest.raises(ValueError, match=reason):
        changed.restore(data)


def test_a_creature_says_what_it_needs_and_repeats_bit_for_bit(course, away):
    experiment, state, _ = course
    file = creature.parse(json.dumps(experiment.best(state)))
    assert check(file).exact
    assert creature_h5.load(creature_h5.dump(file)) == file
    away()
    assert creature.parse(json.dumps(file)) == file, "a file is read without the module"
    with pytest.raises(plugins.Missing, match=r"extra\."):
        check(file)


def test_a_search_begins_only_from_creatures_whose_genes_mean_the_same(course, module, away):
    experiment, state, _ = course
    file = creature.parse(json.dumps(experiment.best(state)))
    same, other = {"plugin": {"settings": {}}}, {"plugin": {"settings": {"strictness": 2}}}

    def begun(body=SPEC["body"], control=same):
        return parse(SPEC | {"body": body, "control": SPEC["control"] | control})

    chosen = begun()
    assert fitting(chosen, file) == file["identity"]["genome"]
    for changed, field in (
        ({"control": other}, "control.plugin.settings"),
        ({"body": {"nodes": 9}}, "body"),
    ):
        with pytest.raises(creature.CreatureError) as raised:
            fitting(begun(**changed), file)
        assert raised.value.field == field
    away()
    assert fitting(chosen, file), "without the body's module, only a worker can count joints"
    module.write_text(MODULE + "# Changed.\n")
    plugins.load(module)
    module.write_text(MODULE)
    with pytest.raises(creature.CreatureError, match=r"control\.plugin\.source"):
        fitting(begun(), file)


def test_a_creature_is_replayed_without_its_measures(course, module, monkeypatch):
    experiment, state, _ = course
    file = experiment.best(state)
    kept = {key: one for key, one in registry._plugins.items() if key[0] == "encoding"}
    whole = read_replay(record(file))
    monkeypatch.setattr(registry, "_plugins", kept)
    replay = read_replay(record(file))
    np.testing.assert_array_equal(replay.positions, whole.positions)
    fitness = whole.header["fitness"]
    assert fitness["replayed"] == pytest.approx(fitness["recorded"], rel=0.1)
    assert replay.header["fitness"]["replayed"] is None


def test_a_measure_that_is_no_number_is_refused_by_name():
    axes = {"descriptors": [{"name": "extra.broken", "bins": 2}]}
    experiment = build(parse({**SPEC, "archive": axes}))
    reason = r"extra\.broken must return one number, got shape"
    with pytest.raises(plugins.Broken, match=reason):
        experiment.advance(experiment.init())


def test_an_unknown_field_of_a_motion_lists_the_known_ones():
    axes = {"descriptors": [{"name": "extra.misspelt", "bins": 2}]}
    experiment = build(parse({**SPEC, "archive": axes}))
    reason = r"a motion has path, heading, .*measures, got 'headings'"
    with pytest.raises((AttributeError, plugins.Broken), match=reason):
        experiment.advance(experiment.init())


def test_a_plugin_gait_swims_in_a_sweep_beside_known_ones(away):
    spec = {
        "experiment": "gaits", "swimmers": ["extra.wiggler"], "forms": ["ours"],
        "viscosities": [0.5], "period": 20, "cycles": 1,
    }  # fmt: skip
    experiment = build(parse(spec))
    _, report = experiment.advance(experiment.init())
    (row,) = report.rows
    assert row.values["swimmer"] == "extra.wiggler"
    assert row.values["displacement"] > 0
    file = creature.document(json.loads(row.identity), row.measured, row.provenance)
    assert creature.parse(file)["sha256"] == row.creature
    chosen = parse(spec).model_dump(mode="json")
    away()
    assert parse(chosen).model_dump(mode="json") == chosen
