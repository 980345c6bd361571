"""The map of an archive shows each elite where it belongs, and the fittest where many do."""

import numpy as np
import pytest
from scipy.spatial import KDTree

from microcosmos.viz.figures import caption, maps, style
from microcosmos.viz.figures.axes import chosen, fitness_label
from microcosmos.viz.figures.maps import borders, cells

pytestmark = pytest.mark.long

THREE = (
    {"name": "bending_effort", "bins": 4},
    {"name": "straightness", "bins": 5},
    {"name": "path_length", "bins": 3},
)


@pytest.fixture(autouse=True)
def printed():
    with style.styled():
        yield


def shown(figure):
    """The numbers of the map's cells, nobody's NaN."""
    (mesh,) = figure.axes[0].collections
    return np.ma.filled(mesh.get_array(), np.nan)


def test_elites_of_a_grid_stand_in_their_cells(made):
    found = made([{"cell": 0, "fitness": 1.5}, {"cell": 7, "fitness": 2.5}])
    expected = np.full((5, 4), np.nan)
    expected[0, 0], expected[2, 1] = 1.5, 2.5  # Cell 7 is bin 1 along x and 2 along y.
    np.testing.assert_array_equal(shown(maps.archive(found)), expected)


def test_of_elites_that_share_a_place_the_fittest_is_shown(made):
    number = np.arange(4 * 5 * 3).reshape(4, 5, 3)
    elites = [{"cell": int(number[1, 2, k]), "fitness": f} for k, f in enumerate((1, 3, 2))]
    elites += [{"cell": int(number[3, 0, 0]), "fitness": 9}]
    values = shown(maps.archive(made(elites, axes=THREE)))
    assert (values[2, 1], values[0, 3], np.isfinite(values).sum()) == (3, 9, 2)
    values = shown(maps.archive(made(elites, axes=THREE), axes=["path_length", "straightness"]))
    assert [values[2, k] for k in range(3)] == [1, 3, 2]


def test_logarithmic_axes_have_decades_and_units(made):
    panel = maps.archive(made([{"cell": 0, "fitness": 1.0}])).axes[0]
    assert (panel.get_xscale(), panel.get_yscale()) == ("log", "linear")
    assert panel.get_xlabel() == "Bending effort [rad²]"
    ticks = panel.get_xticks()
    assert np.allclose(np.log10(ticks), np.round(np.log10(ticks)))


def test_what_was_not_measured_is_refused_with_what_was(made):
    found = made([{"cell": 0, "fitness": 1.0}])
    with pytest.raises(ValueError, match=r"bending_effort, straightness .*got 'speed'"):
        maps.archive(found, axes=["speed"])
    with pytest.raises(ValueError, match=r"`colour` must be one of fitness.*got 'size'"):
        maps.archive(found, colour="size")


def test_voronoi_cells_are_nearest_to_their_centroids_and_fill_the_square():
    centroids = np.random.default_rng(3).random((40, 2))
    found, tree = cells(centroids), KDTree(centroids)
    areas = []
    for number, corners in enumerate(found):
        x, y = corners.T
        areas.append((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2)
        inside = 0.999 * corners + 0.001 * centroids[number]
        assert (tree.query(inside)[1] == number).all()
    np.testing.assert_allclose(sum(areas), 1)


def test_borders_on_one_axis_lie_midway_between_centroids():
    found = borders(np.array([0.9, 0.1, 0.5]))
    np.testing.assert_allclose(found, [[0.7, 1.0], [0.0, 0.3], [0.3, 0.7]])


def test_a_tessellation_is_drawn_as_its_cells_with_elites_in_colour(made):
    centroids = np.random.default_rng(5).random((12, 2))
    found = made(
        [{"cell": 3, "fitness": 1.0}, {"cell": 8, "fitness": 4.0}], centroids=centroids
    )
    everything, filled = maps.archive(found).axes[0].collections
    assert (len(everything.get_paths()), len(filled.get_paths())) == (12, 2)
    np.testing.assert_array_equal(filled.get_array(), [1.0, 4.0])
    x, _ = chosen(found, None)
    corners = filled.get_paths()[0].vertices[:, 0]
    place = x.places(corners)
    assert place.min() <= centroids[3, 0] <= place.max()


def test_one_axis_alone_is_drawn_as_bars_as_high_as_the_fittest(made):
    elites = [{"cell": 0, "fitness": 1.0}, {"cell": 1, "fitness": 3.0}]  # Of one bin along x.
    panel = maps.archive(made(elites), axes=["bending_effort"]).axes[0]
    assert [bar.get_height() for bar in panel.patches] == [3.0]


def test_plugin_measures_have_their_declared_titles(made):
    """Although nobody has their module here."""
    plugin = {"source": "0" * 64, "title": "Sway", "unit": "cells"}
    sway = {"name": "mine.sway", "low": 1e-3, "high": 1.0, "scale": "log10", "plugin": plugin}
    far = plugin | {"title": "Straight way"}
    found = made(
        [{"cell": 0, "fitness": 1.0, "mine.sway": 0.1}, {"cell": 9, "fitness": 2.0}],
        axes=[sway, {"name": "straightness", "bins": 4}],
        task={"fitness": "mine.straight", "plugin": far},
        body={"builder": "mine.cross", "plugin": plugin | {"title": "Cross"}},
    )
    figure = maps.archive(found, colour="mine.sway")
    assert figure.axes[0].get_xlabel() == figure.axes[1].get_ylabel() == "Sway [cells]"
    assert figure.axes[1].get_yscale() == "log"
    assert fitness_label(found) == "Straight way [cells]"
    told = caption.of_archive(found, None)
    assert "over sway [cells] and straightness;" in told
    assert "Fitness is “Straight way” (mine.straight) over 500 steps" in told
    assert "the body “Cross” (mine.cross), controlled by" in told


def test_a_caption_of_one_axis_names_no_ring(made):
    found = made([{"cell": 0, "fitness": 1.0}])
    assert "ring marks" in caption.of_archive(found, None)
    assert "; the fittest has 1." in caption.of_archive(found, ["straightness"])
