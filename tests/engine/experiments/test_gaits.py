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
from microcosmos.build.experiments import build_strokes
from microcosmos.experiments import gaits
from microcosmos.experiments.table_file import TableRun
from microcosmos.spec import EXPERIMENTS, parse
from microcosmos.viz.replay import FRAMES, interval

EXPERIMENT = "gaits"


def file_of(row):
    return creature.document(json.loads(row.identity), row.measured, row.provenance)


def test_every_form_and_viscosity_has_a_row(course):
    states, reports, _, spec = course
    values = [row.values for row in states[-1].rows]
    points = [(row["form"], row["viscosity"]) for row in values]
    assert points == [(form, v) for form in spec.forms for v in spec.viscosities]
    assert reports[-1].summary["points"] == 6
    assert all(row["force_free"] == (row["form"] == "ours") for row in values)


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
        cycle = np.array([measures["cycle_x"], measures["cycle_y"]])
        turn = values["direction"]
        there = values["displacement"] * np.array([np.cos(turn), np.sin(turn)])
        np.testing.assert_allclose(there, cycle, rtol=1e-12)
        assert values["displacement"] <= measures["path_length"]
        assert values["mach"] == measures["mach"] < 1
        assert math.isfinite(values["sperm"])


def test_ours_gives_no_impulse_and_softens_with_viscosity_unlike_the_papers_form(course):
    values = [row.values for row in course[0][-1].rows]
    ours, paper = ([row for row in values if row["form"] == form] for form in ("ours", "paper"))
    assert max(row["impulse"] for row in ours) <= 1e-4
    assert min(row["impulse"] for row in paper) >= 1e-2
    # Soft actuators have a larger sperm number.
    numbers = [row["sperm"] for row in ours]
    assert numbers == sorted(numbers)
    assert numbers[0] < numbers[-1]
    assert len({row["sperm"] for row in paper}) == 1


def test_a_simulation_that_does_not_stay_finite_has_no_numbers(experiment):
    strokes = build_strokes(parse(json.loads(experiment.spec)))
    assert all(stroke.spacing <= units.MAX_SPACING for stroke in strokes)
    names = search.STROKE_MEASURES
    values = np.ones((3, len(names)), np.float32)
    values[1, names.index("mach")] = np.nan
    values[2, names.index("mach")] = 2.0
    found = search.Evaluation(*map(jnp.asarray, (values[:, 0], values, np.array([0, 1, 2]))))
    found = jax.device_get(found)
    rows = partial(gaits.stroke_rows, replace(strokes[0], program=None), block=3, device="cpu")
    same = (experiment.spec, experiment.device)
    broken = TableRun(*same, 1, lambda _, stop: rows(stop), gaits.report)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(search, "evaluate_blocks", lambda *_, **__: found)
        state, report = broken.advance(broken.init())
    sound, infeasible, supersonic = state.rows
    assert [row.values["status"] for row in state.rows] == ["ok", "non-finite", "supersonic"]
    assert report.infeasible == 2
    assert infeasible.creature is None
    assert infeasible.values["displacement"] is None
    assert infeasible.values["warnings"] == "the simulation did not stay finite"
    assert "Mach" in supersonic.values["warnings"]
    assert sound.creature is not None
    assert broken.restore(broken.save(state)) == state


@pytest.mark.fast
def test_every_point_of_every_preset_can_be_watched():
    for preset in EXPERIMENTS["gaits"].presets:
        for form, swimmer in preset.spec.strokes:
            scene = preset.spec.scene(form, swimmer, 0.1)
            assert scene.task.steps / interval(scene, network_nodes=0) <= FRAMES
