"""Folding at a small size: it learns, goes on bit for bit, and shows what it has learnt."""

import json
from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from pydantic import ValidationError

from microcosmos import fields, search
from microcosmos.archive import creature
from microcosmos.archive.file import read_table
from microcosmos.build import build, build_descent
from microcosmos.spec import parse
from microcosmos.viz.replay import record
from microcosmos.viz.replay_file import read_replay

EXPERIMENT = "folding"


@pytest.fixture(scope="module")
def document(specs):
    return specs["folding"]


def test_losses_fall_and_the_best_creature_has_the_least(course):
    state, reports = course[0][-1], course[1]
    best = course.experiment.best(state)
    assert best["sha256"] == state.table.rows[np.argmin(state.folds.least)].creature
    first, least = state.losses[0], state.folds.least
    assert (least < 0.6 * first).all()
    assert len(state.losses) == 20
    assert reports[-1].summary["loss.3"] == pytest.approx(state.losses[-1, 1])
    assert reports[-1].evaluations == 40


@pytest.mark.long
def test_every_filament_is_a_creature_whose_replay_ends_at_its_loss(course):
    state = course[0][-1]
    task = build_descent(course.spec).task
    for number, row in enumerate(state.table.rows):
        file = creature.document(json.loads(row.identity), row.measured, row.provenance)
        assert creature.parse(file)["sha256"] == row.creature
        replay = read_replay(record(file))
        density = fields.splat(jnp.asarray(replay.positions[-1]), task.world.size, 1.0)
        loss = np.mean((fields.saturated(density) - state.folds.picture[number]) ** 2)
        np.testing.assert_allclose(loss, row.values["least"], rtol=1e-3)


def test_a_step_that_is_not_finite_begins_anew_from_the_best(experiment):
    fold = jax.tree.map(lambda x: jnp.asarray(x[:1]), experiment.start)
    best = jnp.full_like(fold.genes, 0.01)
    broken = replace(fold, genes=fold.genes.at[0, 3].set(jnp.inf), best=best)
    after, loss = experiment.program(broken)
    assert not np.isfinite(loss[0])
    np.testing.assert_array_equal(after.genes, best)
    assert after.rate_share[0] == 0.5
    assert all(not np.any(leaf) for leaf in jax.tree.leaves(after.optimiser))


@pytest.mark.long
def test_the_gradient_of_the_loss_agrees_with_central_differences(float64, document):
    descent = build_descent(parse(document | {"steps": 20}))
    descent = jax.tree.map(
        lambda x: x.astype(float64) if jnp.issubdtype(x.dtype, jnp.floating) else x, descent
    )
    picture = jnp.asarray(np.random.default_rng(0).uniform(size=(32, 32)))
    genes, way = np.random.default_rng(1).normal(scale=0.05, size=(2, 62 + 63))
    loss = jax.jit(lambda g: search.folding.loss(descent, g, picture))
    h = 1e-6
    difference = (loss(jnp.asarray(genes + h * way)) - loss(jnp.asarray(genes - h * way))) / 2
    slope = jnp.sum(jax.grad(loss)(jnp.asarray(genes)) * way)
    np.testing.assert_allclose(slope, difference / h, rtol=1e-6)


@pytest.mark.long
def test_in_a_fluid_and_in_segments_it_learns_the_same_at_first(document, carry_out):
    place = {"width": 32, "height": 32, "viscosity": 0.16}
    fluid = document | {"targets": [{"digit": 1}], "world": place, "steps": 40, "updates": 4}
    whole = parse(fluid)
    few = parse(fluid | {"memory": 0.004})
    assert whole.segment is None
    assert 1 < few.segment < 20
    assert few.gradient_bytes < whole.gradient_bytes / 2
    ends = [carry_out(build(spec))[0][-1] for spec in (whole, few)]
    losses = [state.losses[:, 0] for state in ends]
    np.testing.assert_allclose(*losses, rtol=1e-3)
    assert losses[0][-1] < losses[0][0]


PICTURE = {"kind": "picture", "name": "a", "width": 1, "height": 1, "pixels": "AA=="}


@pytest.mark.parametrize(
    ("change", "needed"),
    [
        ({"targets": []}, "at least 1 item"),
        ({"targets": [{"digit": 3}, {"digit": 3}]}, "must have different names"),
        ({"targets": [{"digit": 10}]}, "less than or equal to 9"),
        ({"targets": [{"kind": "film"}]}, "one of digit, picture"),
        ({"targets": [3]}, "one of digit, picture"),
        ({"targets": [{**PICTURE, "width": 2, "height": 2, "pixels": "AA"}]}, "pixels"),
        ({"targets": [PICTURE]}, "must show something"),
        ({"size": 40}, "shorter side of 32, got 40"),
        ({"world": {"width": 32, "height": 32, "energy": {}}}, "`world.energy` must be empty"),
        ({"memory": 1e-6}, "`memory` must be at least"),
        ({"coupling": {"theta_feedback": 0}}, "`projection` must be"),
    ],
)
def test_a_spec_that_cannot_be_carried_out_is_refused(document, change, needed):
    with pytest.raises(ValidationError, match=needed):
        parse(document | change)


def test_the_table_has_a_row_for_each_picture(experiment, course):
    state = course[0][-1]
    table = read_table(experiment.save(state))
    assert [row["picture"] for row in table.rows] == ["1", "3"]
    assert [row["failed"] for row in table.rows] == [0, 0]
    blank = [row["empty"] for row in table.rows]
    np.testing.assert_allclose(blank, np.mean(state.folds.picture**2, (1, 2)), rtol=1e-6)
