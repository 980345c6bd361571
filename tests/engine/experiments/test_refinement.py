"""One creature made fitter within its cell."""

import itertools
import json
from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from pydantic import ValidationError

import microcosmos
from microcosmos.archive import creature
from microcosmos.audit.reproducibility import check
from microcosmos.build import build_cells
from microcosmos.search import MEASURES
from microcosmos.spec import parse

EXPERIMENT = "refinement"


@pytest.fixture
def spec(course):
    return course.spec


@pytest.fixture
def rows(course):
    return course[0][-1].table.rows


def test_refinement_never_lowers_the_fitness(spec, rows):
    fitness = [row.values["fitness"] for row in rows]
    assert len(fitness) == 1 + spec.steps
    assert all(b >= a for a, b in itertools.pairwise(fitness))
    assert fitness[-1] > fitness[0]
    # The first row is the creature as its search has measured it.
    assert rows[0].creature == spec.creature["sha256"]
    assert rows[0].provenance == spec.creature["provenance"]
    assert fitness[0] == pytest.approx(spec.creature["measured"]["fitness"], rel=1e-4)


def test_infeasible_trials_are_refused(course):
    """The same steps, but each trial pushes itself; the creature itself counts in any case."""
    experiment = course.experiment
    assert experiment.feasible

    def pushing(genotypes):
        found = jax.device_get(experiment.evaluate_block(genotypes))
        measures = np.array(found.measures)
        measures[:, MEASURES.index("impulse")] = 1.0
        return eqx.tree_at(lambda one: one.measures, found, measures)

    pushed = replace(experiment, evaluate_block=pushing)
    first, _ = pushed.advance(pushed.init())
    assert np.isfinite(first.fitness)
    second, _ = pushed.advance(first)
    assert second.fitness == first.fitness
    assert experiment.advance(first)[0].fitness > first.fitness


def test_the_refined_creature_keeps_the_licence_and_credit_of_the_given_one(spec, course):
    terms = {"licence": "CC0-1.0", "credit": ["Ada"]}
    chosen = spec.model_dump(mode="json") | {"creature": {**spec.creature, **terms}}
    experiment = replace(course.experiment, spec=json.dumps(chosen))
    first, last = course[0][1], course[0][-1]
    for state in (first, last):
        assert experiment.best(state) == course.experiment.best(state) | terms
    assert experiment.best(first)["sha256"] == spec.creature["sha256"]
    assert experiment.best(last)["sha256"] != spec.creature["sha256"]


def test_refinement_stays_in_the_cell(spec, rows):
    cells = build_cells(spec.archive)
    measures = [row.measured["measures"] for row in rows]
    places = np.array([[one[name] for name in MEASURES] for one in measures], np.float32)
    assert len(set(cells.of(jnp.asarray(places)).tolist())) == 1


@pytest.mark.long
@pytest.mark.optimised
def test_a_refined_creature_repeats_bit_for_bit_and_has_a_parent(spec, course):
    best = course.experiment.best(course[0][-1])
    assert creature.parse(best)["sha256"] == best["sha256"]
    assert best["provenance"]["parents"] == [spec.creature["sha256"]]
    assert best["provenance"]["operator"] == "refinement"
    assert check(best).exact


def test_rows_and_reports_hold_slopes_agreement_gradients_and_trials(course, rows):
    assert rows[0].values["slope"] is None
    assert all(row.values["slope"] > 0 for row in rows[1:])
    # The shortest trial of the first step is 0.05 long.
    assert 0.3 < rows[1].values["agreement"] < 3
    assert [report.evaluations for report in course[1]] == [1, 6, 11, 16, 21]
    assert course[1][-1].best == course[0][-1].fitness


@pytest.mark.long
def test_the_function_refine_gives_the_creature_of_the_run(spec, rows):
    refined, values = microcosmos.refine(spec.creature, steps=2, block=4)
    assert values[-1]["fitness"] >= values[0]["fitness"]
    assert json.dumps(refined)
    assert refined["sha256"] == rows[2].creature


def test_damaged_creatures_and_measures_without_derivatives_are_refused(spec):
    file = spec.creature
    with pytest.raises(ValidationError, match=r"creature\.sha256"):
        parse({"experiment": "refinement", "creature": {**file, "sha256": "0" * 64}})
    pushed = json.loads(json.dumps(file))
    pushed["identity"]["world"]["coupling"]["projection"] = "none"
    pushed["sha256"] = creature.name(pushed["identity"])
    with pytest.raises(ValidationError, match="`feasible` must be false"):
        parse({"experiment": "refinement", "creature": pushed})
    axes = {"descriptors": [{"name": "connections"}]}
    with pytest.raises(ValidationError, match="derivatives for refinement, got 'connections'"):
        parse({"experiment": "refinement", "creature": file, "archive": axes})
