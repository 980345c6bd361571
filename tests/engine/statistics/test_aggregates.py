"""Aggregates over tasks follow Agarwal et al. (2021)."""

import json
from importlib import import_module

import numpy as np
import pytest
from scipy import stats

from microcosmos.statistics import across, named, tables
from microcosmos.statistics.effects import Bootstrap, middle_mean, superiority

TASK = ["world.viscosity"]
BASE = ([1.0, 2, 3, 4, 5], [10.0, 20, 30, 40, 50])
OTHER = ([3.0, 6, 2, 8, 9], [30.0, 25, 90, 70, 10])
FEW = Bootstrap(299)


@pytest.fixture
def groups(group_of):
    def of(scores, width):
        thin, thick = scores
        wide = {"world__width": width}
        return group_of(thin, **wide) + group_of(thick, world__viscosity=0.2, **wide)

    return named({"base": of(BASE, 96), "other": of(OTHER, 128)})


def test_the_interquartile_mean_is_over_all_runs_relative_to_the_first_group(groups):
    found = across(groups, "qd_score", TASK, FEW)
    together = np.sort(np.concatenate([np.divide(OTHER[0], 3), np.divide(OTHER[1], 30)]))
    assert found.groups[1].middle_mean == pytest.approx(together[2:-2].mean())
    low, high = found.groups[1].interval
    assert low < found.groups[1].middle_mean < high
    assert [task["world.viscosity"] for task in found.tasks] == [0.05, 0.2]


def test_many_tasks_are_drawn_many_resamples_at_a_time(run, monkeypatch):
    """One at a time takes 100 times as long; ten tasks of five seeds have 5^10 combinations."""
    drawn, bootstrap = [], stats.bootstrap

    def seen(*given, batch, **more):
        drawn.append(batch)
        return bootstrap(*given, batch=batch, **more)

    monkeypatch.setattr(stats, "bootstrap", seen)
    places = [(task, seed) for task in range(10) for seed in range(5)]
    groups = {
        name: [
            run(1.0 + seed, seed=seed, world__viscosity=0.1 + task, world__width=width)
            for task, seed in places
        ]
        for name, width in (("a", 96), ("b", 128))
    }
    across(named(groups), "best", TASK, FEW)
    assert drawn == [FEW.resamples] * 3


def test_the_probability_of_improvement_is_the_mean_over_tasks(groups):
    (found,) = across(groups, "qd_score", TASK, FEW).improvements
    shares = [
        np.mean([(x > y) + 0.5 * (x == y) for x in base for y in other])
        for base, other in zip(BASE, OTHER, strict=True)
    ]
    assert found.probability == pytest.approx(np.mean(shares))
    assert found.interval[0] <= found.probability <= found.interval[1]


def test_a_performance_profile_is_the_share_of_runs_above_a_score(groups):
    found = across(groups, "qd_score", TASK, FEW)
    scores = np.concatenate([np.divide(BASE[0], 3), np.divide(BASE[1], 30)])
    for score, share in zip(found.scores, found.groups[0].profile, strict=True):
        assert share == pytest.approx(np.mean(scores > score))
    low, high = np.array(found.groups[0].band)
    profile = np.array(found.groups[0].profile)
    assert ((low <= profile) & (profile <= high)).all()
    assert found.groups[1].profile[-1] == 0, "no run is above the greatest score"


def test_tasks_that_a_group_lacks_are_refused(groups, group_of):
    lacking = named({"a": groups[0].runs, "b": group_of(OTHER[0], world__width=128)})
    with pytest.raises(ValueError, match="every group needs the same tasks"):
        across(lacking, "qd_score", TASK, FEW)
    (other,) = group_of([1.0], archive__container={"kind": "x"}, world__width=96)
    mixed = named({"a": [*groups[0].runs, other]})
    with pytest.raises(ValueError, match=r"`archive\.container\.kind` none in .* and x in"):
        across(mixed, "qd_score", TASK, FEW)
    fewer = named({"a": groups[0].runs[:-1]})
    with pytest.raises(ValueError, match="as many runs of every task, got 5, 4"):
        across(fewer, "qd_score", TASK, FEW)


def test_tasks_may_be_lists(run):
    """`search.initial` is a list in every spec, and lists have no hash."""
    runs = [run(float(seed + 1), seed=seed) for seed in range(5)]
    found = across(named({"a": runs}), "qd_score", ["search.initial"], FEW)
    assert found.tasks == ({"search.initial": []},)
    assert "Over 1 task (search.initial" in tables.aggregates_text([found])


def test_tasks_may_be_kinds_which_have_fields_of_their_own(group_of):
    direct = {"encoding": "direct", "genes": 7}
    runs = group_of(BASE[0]) + group_of(BASE[1], control=direct)
    found = across(named({"a": runs}), "qd_score", ["control.encoding"], FEW)
    assert [task["control.encoding"] for task in found.tasks] == ["cppn", "direct"]
    other = group_of([1.0], control=direct | {"genes": 9})
    with pytest.raises(ValueError, match=r"`control\.genes` none in .* and 7 in"):
        across(named({"a": runs + other}), "qd_score", ["control.encoding"], FEW)


def test_differences_and_cautions_are_stated(groups, group_of):
    old = {"world__width": 128, "version": "0.0.9", "curves": {"mean": np.full(4, -1.0)}}
    runs = group_of(OTHER[0], **old) + group_of(OTHER[1], world__viscosity=0.2, **old)
    mixed = [groups[0], *named({"other": runs})]
    several = [across(mixed, measure, TASK, FEW) for measure in ("best", "qd_score")]
    text = tables.aggregates_text(several)
    assert "their specs differ, in this order, in world.width (96, 128). Over 2 tasks" in text
    assert (
        "Runs are of several versions: 0.1.0, 0.0.9. Some runs have negative fitness." in text
    )
    best, qd_score = json.loads(tables.aggregates_json(several))
    assert best["differences"] == qd_score["differences"] == {"world.width": [96, 128]}
    assert [len(one["cautions"]) for one in (best, qd_score)] == [1, 2]


def test_numbers_of_tasks_are_equal_in_any_form(run):
    def made(width, best):
        found = [run(best, seed=seed) for seed in range(5)]
        for one in found:
            one.fields["world.width"] = width
        return found

    runs = {"a": made(96, 1.0), "b": made(96.0, 2.0)}
    (task,) = across(named(runs), "best", ["world.width"], FEW).tasks
    assert task == {"world.width": 96}


def test_a_run_without_elites_has_no_score(run, group_of):
    empty = run(0.0, seed=5, curves={"coverage": np.zeros(4)})
    groups = named({"a": group_of([1.0] * 5), "b": [*group_of([2.0] * 4), empty]})
    with pytest.raises(ValueError, match=r"needs elites in every run, got none in 0-seed5\.h5"):
        across(groups, "best", TASK, FEW)


def test_fewer_than_five_seeds_of_a_task_have_no_interval(group_of):
    few = named({"a": group_of([1.0, 2, 3])})
    found = across(few, "qd_score", TASK, FEW)
    assert (found.groups[0].interval, found.groups[0].band) == (None, None)
    assert found.refusal.endswith("got 3 in 'a'.")


def test_means_and_probabilities_are_those_of_rliable():
    metrics = pytest.importorskip("rliable.metrics", reason="make peers installs rliable")
    import_module("rliable.library")  # It needs a version of arch that knows pandas 3.
    ours, theirs = np.random.default_rng(0).random((2, 7, 4))
    assert middle_mean(*ours.T) == pytest.approx(metrics.aggregate_iqm(ours))
    shares = [superiority(x, y) for x, y in zip(ours.T, theirs.T, strict=True)]
    expected = metrics.probability_of_improvement(ours, theirs)
    assert np.mean(shares) == pytest.approx(expected)
