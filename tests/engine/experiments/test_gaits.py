"""A sweep of gaits: its rows, their agreement with creatures, and rows without numbers."""

import json
import math
from dataclasses import replace
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import search, units
from microcosmos.archive import creature
from microcosmos.audit.reproducibility import check
from microcosmos.build.tables import build_strokes
from microcosmos.experiments import gaits
from microcosmos.experiments.table_file import TableRun
from microcosmos.spec import EXPERIMENTS, parse
from microcosmos.viz.replay import FRAMES, interval

EXPERIMENT = "gaits"


def file_of(row):
    return creature.document(json.loads(row.identity), row.measured, row.provenance)


def test_every_form_and_viscosity_has_a_row(course):
    states, reports, _, spec = course
    found = [(r.values["form"], r.values["viscosity"]) for r in states[-1].rows]
    assert found == [(form, v) for form in spec.forms for v in spec.viscosities]
    assert reports[-1].summary["points"] == 6
    assert {r.values["form"]: r.values["force_free"] for r in states[-1].rows} == {
        "ours": True,
        "paper": False,
    }


@pytest.mark.optimised
def test_a_check_of_a_row_repeats_every_number_exactly(course):
    for row in (course[0][-1].rows[0], course[0][-1].rows[-1]):
        result = check(file_of(row))
        assert result.same_device
        assert result.exact
        assert set(result.repeated) == set(search.STROKE_MEASURES)


def test_rows_agree_with_what_was_measured_of_their_creature(course):
    for row in course[0][-1].rows:
        values, file = row.values, creature.parse(file_of(row))
        measures = file["measured"]["measures"]
        assert file["sha256"] == row.creature
        assert file["identity"]["world"]["viscosity"] == values["viscosity"]
        assert values["displacement"] == measures["cycle"]
        assert measures["cycle"] <= measures["path_length"]
        assert values["mach"] == measures["mach"] < 1
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


def test_a_simulation_that_does_not_stay_finite_has_no_numbers(experiment):
    stroke = build_strokes(parse(json.loads(experiment.spec)))[0]
    names = search.STROKE_MEASURES
    values = np.ones((3, len(names)), np.float32)
    values[1, names.index("mach")] = np.nan
    values[2, names.index("mach")] = 2.0
    found = search.Evaluation(*map(jnp.asarray, (values[:, 0], values, np.array([0, 1, 2]))))
    found = jax.device_get(found)
    rows = partial(gaits.stroke_rows, replace(stroke, program=None), block=3, device="cpu")
    broken = TableRun(
        experiment.spec, experiment.device, 1, lambda _, stop: rows(stop), gaits.report
    )
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


def test_the_spacing_that_warns_is_the_widest(experiment):
    strokes = build_strokes(parse(json.loads(experiment.spec)))
    assert all(stroke.spacing <= units.MAX_SPACING for stroke in strokes)


@pytest.mark.fast
def test_every_point_of_every_preset_can_be_watched():
    for preset in EXPERIMENTS["gaits"].presets:
        for form, swimmer in preset.spec.strokes:
            scene = preset.spec.scene(form, swimmer, 0.1)
            assert scene.task.steps / interval(scene, network_nodes=0) <= FRAMES
