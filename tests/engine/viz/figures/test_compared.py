"""Figures of compared groups draw every run, and state seeds, tests and correction."""

import numpy as np
import pytest
from matplotlib.colors import to_hex

from microcosmos.statistics import RunRecord, across, by_spec, compare, named
from microcosmos.statistics.effects import Bootstrap
from microcosmos.viz.figures import caption, compared, curves, style

pytestmark = pytest.mark.long

SCORES = {0.05: [1.0, 2, 3, 4, 5], 0.2: [4.0, 6, 5, 9, 7], 0.8: [8.0, 11, 10, 12, 30]}
ELITES = [{"cell": 0, "fitness": 1.0}]
FEW = Bootstrap(99)


@pytest.fixture(autouse=True)
def printed():
    with style.styled():
        yield


@pytest.fixture
def record(made):
    def make(score, seed, **more):
        found = made(ELITES, seed=seed, best=(score / 2, score), **more)
        curves = found.curves
        name = f"{score}-{seed}.h5"
        return RunRecord(name, found.document, curves, "0.1.0", found.devices, "finished")

    return make


@pytest.fixture
def groups(record):
    return named(
        {
            f"viscosity {v}": [
                record(x, s, world={"viscosity": v}) for s, x in enumerate(scores)
            ]
            for v, scores in SCORES.items()
        }
    )


@pytest.fixture
def found(groups):
    return compare(groups, ["best", "coverage"], FEW)


def points(panel, marker):
    return [line for line in panel.get_lines() if line.get_marker() == marker]


def test_a_box_shows_every_run_and_the_median(found):
    figure = compared.boxes(found)
    best, coverage = figure.axes
    shown = [sorted(line.get_ydata()) for line in points(best, "o")]
    assert shown == [sorted(scores) for scores in SCORES.values()]
    medians = [line.get_ydata()[0] for line in best.get_lines() if len(line.get_ydata()) == 2]
    assert medians == [np.median(scores) for scores in SCORES.values()]
    quartiles = [(box.get_y(), box.get_y() + box.get_height()) for box in best.patches]
    expected = [np.quantile(scores, (0.25, 0.75)) for scores in SCORES.values()]
    np.testing.assert_allclose(quartiles, expected)
    ticks = [text.get_text() for text in best.get_xticklabels()]
    assert (ticks, best.get_xlabel()) == (["0.05", "0.2", "0.8"], "Viscosity")
    assert coverage.get_ylabel() == "Coverage [%]"
    assert max(points(coverage, "o")[0].get_ydata()) == 50


def test_runs_that_do_not_arrive_stand_at_the_top(groups):
    late = compare(groups, ["best>=9"], FEW)
    (panel,) = compared.boxes(late).axes
    counts = [len(line.get_ydata()) for line in points(panel, "^")]
    assert counts == [5, 4, 1]
    assert "Triangles at the top are runs that do not" in caption.of_boxes(late)


def test_a_parameter_is_drawn_by_medians_between_quartiles(found):
    best = compared.parameter(found, "world.viscosity").axes[0]
    (line,) = points(best, "o")
    assert dict(zip(*line.get_data(), strict=True)) == {
        viscosity: np.median(scores) for viscosity, scores in SCORES.items()
    }
    assert best.get_xscale() == "log"
    assert best.get_xlabel() == "World viscosity"
    assert len(points(best, ".")) == 3
    text = caption.of_parameter(found, "world.viscosity")
    assert "Each has n = 5, seeds 0 to 4." in text
    assert "p after Holm’s correction for 6 tests" in text
    assert "Best fitness: viscosity 0.05 against viscosity 0.2, p = " in text
    assert "All else as in the first run: MAP-Elites (emitter neat), 2 generations" in text


def test_specs_that_differ_in_a_part_are_lines_of_their_own(record):
    novelty = {"container": {"kind": "dominated-novelty"}}
    specs = [(0.05, {}), (0.2, {}), (0.05, novelty)]
    runs = [
        record(1.0 + n, 0, world={"viscosity": v}, **more) for n, (v, more) in enumerate(specs)
    ]
    lines = compared.series(compare(by_spec(runs), ["best"], FEW), "world.viscosity")
    assert lines == {
        "container kind none": [(0.05, 0), (0.2, 1)],
        "container kind dominated-novelty": [(0.05, 2)],
    }


def test_names_of_groups_are_drawn_as_they_are(record):
    names = ("_a", r"b$\frac$")
    groups = named({name: [record(float(i), i)] for i, name in enumerate(names)})
    figure = curves.curves(groups, shown=["best"])
    style.encoded(figure, ".svg")
    (legend,) = figure.legends
    assert [one.get_text().strip("\u200b") for one in legend.get_texts()] == [
        f"{name} (n = 1)" for name in names
    ]
    box = compared.boxes(compare(groups, ["best"], FEW))
    style.below(box, caption.of_boxes(compare(groups, ["best"], FEW)))
    assert rb"\frac" in style.encoded(box, ".svg")
    with pytest.raises(
        ValueError, match="need letters that the font DejaVu Sans has; got '游'"
    ):
        curves.curves(named({"游泳": groups[0].runs}), shown=["best"])


def test_a_field_that_is_no_parameter_is_refused(found, record):
    with pytest.raises(ValueError, match=r"\(it may be world.viscosity\), got world.width"):
        compared.parameter(found, "world.width")
    kinds = [{"fitness": "displacement"}, {"fitness": "speed"}]
    named_kinds = {
        kind["fitness"]: [record(float(i + n), i, task=kind) for i in range(5)]
        for n, kind in enumerate(kinds)
    }
    words = compare(named(named_kinds), ["best"], FEW)
    with pytest.raises(ValueError, match="must be a number in every group, got 'displacement'"):
        compared.parameter(words, "task.fitness")


def test_profiles_are_drawn_with_bands(record):
    runs = [
        record(x, s, world={"viscosity": v}) for v, y in SCORES.items() for s, x in enumerate(y)
    ]
    found = across(named({"ours": runs}), "best", ["world.viscosity"], FEW)
    (panel,) = compared.profiles(found).axes
    line = panel.get_lines()[0]
    np.testing.assert_allclose(line.get_ydata(), found.groups[0].profile)
    assert to_hex(line.get_color()).upper() == style.COLOURS[0]
    assert len(panel.collections) == 1
    text = caption.of_profiles(found, runs[0])
    assert "Over 3 tasks" in text
    assert "with 95 % bands" in text
