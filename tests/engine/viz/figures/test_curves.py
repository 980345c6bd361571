"""Curves show medians and quartiles over seeds, and tell specs apart by what differs."""

from dataclasses import replace

import numpy as np
import pytest

from microcosmos.viz.figures import caption, curves, style
from microcosmos.viz.figures.groups import grouped

pytestmark = pytest.mark.long

ELITES = [{"cell": 0, "fitness": 1.0}]


@pytest.fixture(autouse=True)
def printed():
    with style.styled():
        yield


@pytest.fixture
def runs(made):
    """Five seeds at one viscosity and two at another, the last one unfinished."""
    thin = [made(ELITES, seed=s, best=(s, s**2, 2 * s**2)) for s in range(5)]
    thick = {"world": {"viscosity": 0.5}}
    return [
        *thin,
        made(ELITES, seed=7, best=(1, 2, 3), **thick),
        made(ELITES, seed=8, best=(3, 4), **thick),
    ]


def lines(panel):
    return [line for line in panel.get_lines() if line.get_label() != "_run"]


def test_a_group_is_drawn_by_its_median_between_its_quartiles(runs):
    panel = curves.curves(grouped(runs[:5])).axes[0]
    (median,) = lines(panel)
    seeds = np.arange(5.0)
    expected = np.stack([seeds, seeds**2, 2 * seeds**2])
    np.testing.assert_allclose(median.get_ydata(), np.median(expected, 1))
    np.testing.assert_allclose(median.get_xdata(), [16, 32, 48])
    (band,) = panel.collections
    corners = band.get_paths()[0].vertices
    for x, values in zip((16, 32, 48), expected, strict=True):
        own = corners[corners[:, 0] == x, 1]
        np.testing.assert_allclose([own.min(), own.max()], np.quantile(values, (0.25, 0.75)))
    assert sum(line.get_label() == "_run" for line in panel.get_lines()) == 5


def test_specs_are_told_apart_by_the_fields_in_which_they_differ(runs):
    figure = curves.curves(grouped(runs), shown=["best"], against="generations")
    (legend,) = figure.legends
    texts = [text.get_text() for text in legend.get_texts()]
    assert texts == ["world viscosity 0.05 (n = 5)", "world viscosity 0.5 (n = 2)"]
    thick = lines(figure.axes[0])[1]
    np.testing.assert_allclose(thick.get_xdata(), [1, 2])  # As long as both runs went on.
    np.testing.assert_allclose(thick.get_ydata(), [2, 3])
    told = caption.of_curves(grouped(runs), ["best", "hit_rate", "qd_score"])
    assert told.startswith("Best fitness, hit rate and QD score: median over seeds (thick)")
    assert "; medians and bands as far as all seeds went. " in told
    assert "world viscosity 0.5: seeds 7, 8" in told


def test_a_run_that_is_given_twice_is_refused(runs):
    with pytest.raises(ValueError, match="got seed 2 twice"):
        grouped([runs[0], runs[2], runs[2]])


def test_a_curve_that_is_not_there_is_refused_with_those_that_are(runs):
    with pytest.raises(ValueError, match=r"best, coverage, .*got 'speed'"):
        curves.curves(grouped(runs), shown=["speed"])
    with pytest.raises(ValueError, match="one or more of best, coverage"):
        curves.curves(grouped(runs), shown=[])
    extra = replace(runs[0], curves=runs[0].curves | {"speed": runs[0].curves["best"]})
    with pytest.raises(ValueError, match="got 'speed'"):  # Of one run alone.
        curves.curves(grouped([extra, runs[1]]), shown=["speed"])


def test_coverage_is_drawn_in_per_cent(runs):
    panel = curves.curves(grouped(runs[:1]), shown=["coverage"]).axes[0]
    (line,) = lines(panel)
    np.testing.assert_allclose(line.get_ydata(), [0, 25, 50])
    assert panel.get_ylabel() == "Coverage [%]"
