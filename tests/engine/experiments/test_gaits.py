"""A sweep of gaits: the same table however often it is interrupted."""

import json
import math
from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import search, units
from microcosmos.archive import creature
from microcosmos.audit.reproducibility import check
from microcosmos.build import build
from microcosmos.experiments.gaits import Gaits
from microcosmos.spec import EXPERIMENTS, parse
from microcosmos.viz.replay import FRAMES, interval

SPEC = {
    "experiment": "gaits",
    "swimmers": ["ray"],
    "forms": ["ours", "paper"],
    "viscosities": [0.05, 0.5, 2.0],
    "period": 30,
    "cycles": 2,
    "block": 2,
}


@pytest.fixture(scope="module")
def sweep():
    return build(parse(SPEC))


@pytest.fixture(scope="module")
def course(sweep, carry_out):
    """States and reports of the whole run, the initial state first."""
    return carry_out(sweep)


def file_of(row):
    return creature.document(json.loads(row.identity), row.measured, row.provenance)


def test_every_form_and_viscosity_has_a_row(course):
    states, reports = course
    found = [(r.values["form"], r.values["viscosity"]) for r in states[-1].rows]
    assert found == [(form, v) for form in SPEC["forms"] for v in SPEC["viscosities"]]
    assert [report.generation for report in reports] == [1, 2]
    assert reports[-1].summary["points"] == 6
    assert {r.values["form"]: r.values["force_free"] for r in states[-1].rows} == {
        "ours": True,
        "paper": False,
    }


def test_a_run_taken_up_from_its_file_ends_with_the_same_bytes(sweep, course):
    states, reports = course
    taken_up = sweep.restore(sweep.save(states[1]))
    state, report = build(parse(SPEC)).advance(taken_up)
    assert sweep.save(state) == sweep.save(states[2])
    assert report == reports[1]


def test_a_wish_to_stop_is_obeyed_between_blocks(sweep, course):
    asked = iter([False, True])
    with pytest.raises(search.Stopped):
        sweep.advance(course[0][0], lambda: next(asked))


def test_a_file_of_another_spec_is_refused(sweep, course):
    other = build(parse({**SPEC, "period": 31}))
    with pytest.raises(ValueError, match="spec"):
        other.restore(sweep.save(course[0][1]))


@pytest.mark.optimised
def test_a_check_of_a_row_repeats_every_number_exactly(course):
    for row in (course[0][-1].rows[0], course[0][-1].rows[-1]):
        result = check(file_of(row))
        assert result.same_device
        assert result.exact
        assert set(result.repeated) == set(search.STROKE_FEATURES)


def test_rows_agree_with_what_was_measured_of_their_creature(course):
    for row in course[0][-1].rows:
        values, file = row.values, creature.parse(file_of(row))
        features = file["measured"]["features"]
        assert file["sha256"] == row.creature
        assert file["identity"]["world"]["viscosity"] == values["viscosity"]
        assert values["displacement"] == features["cycle"]
        assert features["cycle"] <= features["path_length"]
        assert values["mach"] == features["mach"] < 1
        assert math.isfinite(values["sperm"])


def test_ours_gives_no_impulse_and_the_papers_form_does(course):
    impulses = {"ours": [], "paper": []}
    for row in course[0][-1].rows:
        impulses[row.values["form"]].append(row.values["impulse"])
    assert max(impulses["ours"]) <= 1e-4
    assert min(impulses["paper"]) >= 1e-2


def test_soft_actuators_have_a_larger_sperm_number(course):
    ours = [r.values["sperm"] for r in course[0][-1].rows if r.values["form"] == "ours"]
    paper = [r.values["sperm"] for r in course[0][-1].rows if r.values["form"] == "paper"]
    assert ours == sorted(ours)
    assert ours[0] < ours[-1]
    assert len(set(paper)) == 1


def test_a_simulation_that_does_not_stay_finite_has_no_numbers(sweep):
    stroke = sweep.strokes[0]
    names = search.STROKE_FEATURES
    values = np.ones((3, len(names)), np.float32)
    values[1, names.index("mach")] = np.nan
    values[2, names.index("mach")] = 2.0
    found = search.Evaluation(*map(jnp.asarray, (values[:, 0], values, np.array([0, 1, 2]))))
    found = jax.device_get(found)
    broken = Gaits(sweep.spec, (replace(stroke, program=None),), 3, sweep.device)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(search, "evaluate_blocks", lambda *_, **__: found)
        state, report = broken.advance(broken.init())
    sound, diverged, supersonic = state.rows
    assert [row.values["status"] for row in state.rows] == ["ok", "non-finite", "supersonic"]
    assert report.diverged == 2
    assert diverged.creature is None
    assert diverged.values["displacement"] is None
    assert diverged.values["warnings"] == "the simulation did not stay finite"
    assert "Mach" in supersonic.values["warnings"]
    assert sound.creature is not None
    assert broken.restore(broken.save(state)) == state


def test_the_spacing_that_warns_is_the_widest(sweep):
    assert all(stroke.spacing <= units.WIDEST for stroke in sweep.strokes)


@pytest.mark.fast
def test_every_point_of_every_preset_can_be_watched():
    for preset in EXPERIMENTS["gaits"].presets:
        for form, swimmer in preset.spec.strokes:
            scene = preset.spec.scene(form, swimmer, 0.1)
            assert scene.task.steps / interval(scene, network_nodes=0) <= FRAMES
