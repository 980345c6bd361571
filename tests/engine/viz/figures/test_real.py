"""Captions of groups state physical units that follow from the numbers by hand."""

import pytest

from microcosmos.quantities.real import Real
from microcosmos.statistics import Group, RunRecord, compare, named
from microcosmos.statistics.effects import Bootstrap
from microcosmos.viz.figures import caption
from microcosmos.viz.figures.reading import grouped

REAL = Real(1e-3, 0.5)
PERIOD, NODES = 200, 21
"""A body of 20 cells is 1 mm and 200 steps are 0.5 s: a cell is 50 µm, a step 2.5 ms."""
PARTS = {"body": {"nodes": NODES}, "control": {"period": PERIOD}}
ELITES = [{"cell": 0, "fitness": 1.0}]


@pytest.fixture
def run(made):
    def make(best, seed, **more):
        return made(ELITES, seed=seed, best=(best / 2, best), **PARTS | more)

    return make


@pytest.fixture
def record(run):
    def make(best, seed, **more):
        found = run(best, seed, **more)
        name = f"{best}-{seed}.h5"
        return RunRecord(name, found.document, found.curves, "1", found.devices, "finished")

    return make


def of(record, measures, **groups):
    runs = {
        name: [record(*one, **more) for one in given] for name, (given, more) in groups.items()
    }
    return caption.comparison_in_units(compare(named(runs), measures, Bootstrap(99)), REAL)


def test_a_speed_of_lengths_is_in_metres_and_seconds(record):
    seeds = ([(0.1, 0), (0.5, 1), (0.9, 2)], {"world": {"viscosity": 0.1}})
    fast = ([(0.2, 0), (1.0, 1), (3.0, 2)], {"world": {"viscosity": 0.4}})
    text = of(record, ["best", "coverage"], slow=seeds, fast=fast)
    # 0.5 lengths in 1,000 steps are 0.5 mm in 2.5 s; ν = 0.1 (50 µm)² / 2.5 ms.
    assert text == (
        " With a body of 1 mm and a stroke of 500 ms at the clock's own pace, the median "
        "best fitness is 200 µm/s (slow), 400 µm/s (fast), and the kinematic viscosity is "
        "0.1 mm²/s, less than common liquids: that of acetone is 3.9 times as high (slow), "
        "0.4 mm²/s, as acetone (fast)."
    )


def test_a_value_to_reach_is_in_units_and_equal_numbers_stand_once(record):
    same = {"world": {"viscosity": 0.4}}
    runs = {"a": ([(0.5, 0)], same), "b": ([(0.7, 1)], same)}
    text = of(record, ["best>=0.5"], **runs)
    assert (
        "the best fitness of 0.5 is 200 µm/s, and the kinematic viscosity is 0.4 mm²/s" in text
    )


def test_curves_state_the_last_median_of_each_group(run):
    runs = [run(0.5, 0), run(0.7, 1), run(0.9, 2)]
    text = caption.curves_in_units(grouped(runs), ["best", "qd_score"], REAL)
    assert "the median best fitness at the end is 280 µm/s, and the kinematic" in text


def test_the_last_median_is_where_the_shortest_run_ends(made, run):
    """The figure's median ends at the second generation, where the long run has 0.6."""
    long = made(ELITES, seed=0, best=(0.3, 0.6, 9.0), **PARTS)
    text = caption.curves_in_units(grouped([long, run(0.5, 1), run(0.7, 2)]), ["best"], REAL)
    assert "the median best fitness at the end is 240 µm/s" in text


def test_many_groups_are_stated_from_the_least_to_the_greatest(record):
    scores = [0.5, 0.1, 2.0, 0.3, 0.4, 0.6, 0.7]
    viscosities = [0.1, 0.4, 0.2, 0.3, 0.35, 0.38, 0.12]
    groups = {
        f"g{n}": ([(score, 0)], {"world": {"viscosity": viscosity}})
        for n, (score, viscosity) in enumerate(zip(scores, viscosities, strict=True))
    }
    text = of(record, ["best"], **groups)
    assert "fitness is 40 µm/s (g1) to 800 µm/s (g2), and the kinematic viscosity is" in text
    assert "3.9 times as high (g0) to 0.4 mm²/s, as acetone (g1)." in text


def test_groups_of_one_name_are_all_stated(run):
    runs = [run(0.5, 0), run(1.0, 0, world={"viscosity": 0.4})]
    groups = [Group("same", (one,)) for one in runs]
    text = caption.curves_in_units(groups, ["best"], REAL)
    assert "at the end is 200 µm/s (same), 400 µm/s (same)" in text


def test_worlds_without_a_fluid_are_refused(record):
    with pytest.raises(ValueError, match=r"`world.fluid` must be true for physical units"):
        of(record, ["best"], a=([(0.5, 0)], {"world": {"fluid": False}}))
