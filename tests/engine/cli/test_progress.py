"""The line of a run's progress, and what commands say."""

from types import SimpleNamespace

import pytest
from few_reports import report_of

from microcosmos.cli.app import progress_bar, say
from microcosmos.cli.run import _summary

pytestmark = pytest.mark.fast


def test_a_run_without_an_elite_says_what_happened_instead_of_a_fitness_of_zero():
    figures = {"infeasible.crossing": 5, "infeasible.supersonic": 3}
    barren = report_of(2, coverage=0.0, qd_score=0.0, best=0.0, infeasible=16, summary=figures)
    assert _summary(barren) == "no elite: 16 of 16 infeasible  crossing  supersonic"
    found = report_of(2, coverage=0.25, best=0.5)
    assert _summary(found) == "QD score 1.50  coverage 25.0 %  best 0.50"


TYPED = "a[v2].h5 [/x] :fire: " + "x" * 100


def test_what_people_typed_is_said_as_it_is(capsys):
    say(TYPED)
    assert capsys.readouterr().err == TYPED + "\n"
    column = progress_bar().columns[-1]
    assert column.render(SimpleNamespace(description=TYPED)).plain == TYPED
