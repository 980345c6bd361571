"""Curves, contact sheets and family trees of archives."""

from dataclasses import replace

import numpy as np
import pytest

from microcosmos.statistics import Group
from microcosmos.viz.figures import caption, curves, style
from microcosmos.viz.figures.lineage import family, lineage
from microcosmos.viz.figures.maps import archive as archive_map
from microcosmos.viz.figures.reading import grouped
from microcosmos.viz.figures.sheet import Motion, layout, reading_order, sheet

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
    thick = [(7, (1, 2, 3)), (8, (3, 4))]
    return thin + [made(ELITES, seed=s, best=b, world={"viscosity": 0.5}) for s, b in thick]


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


def test_nothing_is_drawn_while_an_archive_is_empty(runs):
    for one in runs[:3]:
        one.curves["coverage"][:2] = 0
    panel = curves.curves(grouped(runs[:5])).axes[0]
    (median,) = lines(panel)
    assert np.isfinite(median.get_ydata()).tolist() == [False, False, True]
    assert panel.get_ylim()[0] > -10


def test_corrected_curves_lead_through_the_generations_with_numbers(runs):
    for seed, one in enumerate(runs[:3]):
        one.curves["corrected_qd_score"] = np.array([np.nan, seed, 3.0 * seed])
    panel = curves.curves(grouped(runs[:3]), shown=["corrected_qd_score"]).axes[0]
    (median,) = lines(panel)
    assert median.get_xydata().tolist() == [[32, 1], [48, 3]]
    single = [line.get_xydata().tolist() for line in panel.get_lines() if line != median]
    assert single == [[[32, s], [48, 3 * s]] for s in range(3)]
    (band,) = panel.collections
    assert np.isfinite(band.get_paths()[0].vertices).all()
    # With one number a line has no length.
    for one in runs[:3]:
        one.curves["corrected_qd_score"][1] = np.nan
    panel = curves.curves(grouped(runs[:3]), shown=["corrected_qd_score"]).axes[0]
    assert {line.get_marker() for line in panel.get_lines()} == {"."}
    runs[0].curves["corrected_qd_score"][2] = np.nan
    with pytest.raises(ValueError, match="generation with `corrected_qd_score` of all runs"):
        curves.curves(grouped(runs[:3]), shown=["corrected_qd_score"])


def test_sums_of_negative_fitness_have_a_caution(runs):
    said = "Some runs have negative fitness."
    assert said not in caption.of_curves(grouped(runs), ["best", "qd_score"])
    runs[5].curves["best"][:] = -1
    assert said in caption.of_curves(grouped(runs), ["best", "qd_score"])
    assert said in caption.of_curves(grouped(runs[5:]), ["qd_score"])
    assert said not in caption.of_curves(grouped(runs), ["best", "coverage"])


def test_specs_are_told_apart_by_the_fields_in_which_they_differ(runs):
    figure = curves.curves(grouped(runs), shown=["best"], against="generations")
    (legend,) = figure.legends
    texts = [text.get_text() for text in legend.get_texts()]
    assert texts == ["world viscosity 0.05 (n = 5)", "world viscosity 0.5 (n = 2)"]
    thick = lines(figure.axes[0])[1]
    np.testing.assert_allclose(thick.get_xdata(), [1, 2])  # As long as both runs went on.
    np.testing.assert_allclose(thick.get_ydata(), [2, 3])
    text = caption.of_curves(grouped(runs), ["best", "hit_rate", "qd_score"])
    assert text.startswith("Best fitness, hit rate and QD score: median over seeds (thick)")
    assert "; medians and bands end with the shortest run. " in text
    assert "elites again" not in text
    runs[0].curves["corrected_qd_score"] = np.ones(len(runs[0].curves["best"]))
    again = "; evaluations count those of elites again. "
    assert again in caption.of_curves(grouped(runs), ["best"])
    assert again not in caption.of_curves(grouped(runs), ["best"], "generations")
    assert "their specs differ, in this order, in world.viscosity (0.05, 0.5). " in text
    assert "world viscosity 0.5 has n = 2, seeds 7, 8. All else as in the first run" in text


def test_specs_with_equal_labels_are_numbered(made):
    """Labels are cut after three fields."""
    world = {"viscosity": 0.5, "width": 64, "height": 64}
    others = [made(ELITES, world=world, task={"steps": steps}) for steps in (500, 600)]
    runs = [made(ELITES), *others]
    names = [group.name for group in grouped(runs)]
    assert len(set(names)) == 3
    assert all(name.endswith(f" … ({number})") for number, name in enumerate(names, 1))


def test_the_caption_of_named_groups_names_the_fields_in_which_they_differ(runs):
    groups = [Group("thin", tuple(runs[:5])), Group("thick", tuple(runs[5:]))]
    text = caption.of_curves(groups, ["best"])
    assert "Groups: thin, thick; their specs differ, in this order, in world.viscosity" in text


def test_one_generation_is_not_several(made):
    text = caption.of_curves(grouped([made(ELITES, best=(1,))]), ["best"])
    assert "(emitter neat), 1 generation of 64 (16 evaluations, seed 0)" in text


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


@pytest.fixture
def found(made):
    """Three elites in the lower left, of which the second is fittest, and one far away."""
    places = [(1e-4, 0.0), (2e-4, 0.1), (3e-4, 0.05), (90.0, 0.95)]
    elites = [
        {"cell": k, "fitness": f, "bending_effort": x, "straightness": y}
        for k, ((x, y), f) in enumerate(zip(places, (1.0, 3.0, 2.0, 0.5), strict=True))
    ]
    return made(elites)


def test_the_fittest_of_each_region_is_shown_where_it_belongs(found):
    plan = layout(found, columns=3, rows=2)
    assert [(r.column, r.row, r.elite) for r in plan.regions] == [(0, 0, 1), (2, 1, 3)]
    assert reading_order(plan.regions) == [1, 0]


def test_dollars_in_titles_of_axes_are_no_mathematics(found):
    plan = layout(found, columns=3, rows=2)
    still = Motion(np.zeros((2, 2, 2)), np.array([[0, 1]]))
    panel = sheet(found, plan, [still, still], moments=2).axes[0]
    assert not panel.xaxis.label.get_parse_math()
    assert not panel.yaxis.label.get_parse_math()
    bars = archive_map(found, axes=["bending_effort"]).axes[0]
    assert not bars.yaxis.label.get_parse_math()


PARENTS = [(), (), (0,), (0, 1), (2,), (3, 2), (1,)]
"""The parents of seven entries: two newcomers, and two entries with two parents."""

GENERATIONS = [1, 1, 2, 3, 4, 5, 5]
CELLS = [0, 1, 2, 3, 0, 4, 1]
"""Entries 4 and 6 replaced 0 and 1."""


def name(entry):
    return np.full(32, entry + 1, np.uint8)


@pytest.fixture
def archive(made):
    parents = np.zeros((7, 2, 32), np.uint8)
    for entry, own in enumerate(PARENTS):
        for k, parent in enumerate(own):
            parents[entry, k] = name(parent)
    creatures = np.stack([name(entry) for entry in range(7)])
    columns = {"creature": creatures, "parents": parents, "fitness": np.arange(7.0)}
    columns |= {"generation": np.array(GENERATIONS), "cell": np.array(CELLS)}
    elites = [{"cell": cell, "fitness": float(e)} for cell, e in enumerate((4, 6, 2, 3, 5))]
    return made(elites, best=range(1, 6), lineage=columns)


def test_elites_are_the_latest_entries_and_ancestors_those_of_both_parents(archive):
    found = family(archive)
    assert found.tips.tolist() == [4, 6, 2, 3, 5]
    assert found.ancestors([5]) == [5, 3, 2, 1, 0]
    assert found.ancestors([4]) == [4, 2, 0]
    assert found.ancestors([5], both=False) == [5, 3, 0]


def test_the_chosen_elite_and_all_its_ancestors_are_drawn_in_colour_and_counted(archive):
    panel = lineage(archive, cell=4).axes[0]
    chosen, ring = panel.collections[-2:]
    generations = sorted(int(x) for x, _ in chosen.get_offsets())
    assert generations == [1, 1, 2, 3, 5]
    assert ring.get_offsets()[0][0] == 5
    dashed = [line for line in panel.get_lines() if line.get_linestyle() == "--"]
    assert len(dashed) == 2
    text, counts = caption.of_lineage(archive, 4, 4), "5 elites (grey) and the 4 ancestors"
    assert text.startswith(f"Descent of {counts} of the elite of cell 4")
    assert "Dashed lines lead from second parents." in text


def test_an_empty_cell_is_refused_with_those_that_are_not(archive):
    with pytest.raises(ValueError, match="`cell` must be one of the 5 that have an elite"):
        lineage(archive, cell=17)
