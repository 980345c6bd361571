"""Maps of archives show each elite in its cell; files are reproducible and captioned."""

import re
import time

import numpy as np
import pytest
from scipy.spatial import KDTree

from microcosmos.latex import latex
from microcosmos.viz.figures import caption, maps, reading, style
from microcosmos.viz.figures.maps import cells
from microcosmos.viz.figures.reading import chosen

pytestmark = pytest.mark.long

BINS = {"bending_effort": 4, "straightness": 5, "path_length": 3}
THREE = [{"name": name, "bins": bins} for name, bins in BINS.items()]
ONE = [{"cell": 0, "fitness": 1.0}]


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


def test_the_fittest_of_elites_in_one_place_is_shown(made):
    number = np.arange(4 * 5 * 3).reshape(4, 5, 3)
    elites = [{"cell": int(number[1, 2, k]), "fitness": f} for k, f in enumerate((1, 3, 2))]
    elites += [{"cell": int(number[3, 0, 0]), "fitness": 9}]
    values = shown(maps.archive(made(elites, axes=THREE)))
    assert (values[2, 1], values[0, 3], np.isfinite(values).sum()) == (3, 9, 2)
    values = shown(maps.archive(made(elites, axes=THREE), axes=["path_length", "straightness"]))
    assert [values[2, k] for k in range(3)] == [1, 3, 2]


def test_elites_of_a_container_stand_where_their_measures_are(made):
    """Whatever the numbers of their places."""
    low, high = {"bending_effort": 1e-3}, {"bending_effort": 10.0}
    elites = [
        {"cell": 0, "fitness": 1.0, "straightness": 0.9} | high,
        {"cell": 63, "fitness": 2.0, "straightness": 0.1} | low,
        {"cell": 7, "fitness": 3.0, "straightness": 0.1} | low,
    ]
    found = made(elites, container={"kind": "dominated-novelty", "size": 64})
    values = shown(maps.archive(found))
    assert np.argwhere(np.isfinite(values)).tolist() == [[0, 0], [4, 3]]
    assert (values[0, 0], values[4, 3]) == (3.0, 1.0)
    text = caption.of_archive(found, None)
    assert "Archive of 3 elites; they cover 50.0 % of 20 cells over bending" in text
    assert "Where elites share a place, the fittest is shown. MAP-Elites with" in text


def test_an_unknown_measure_is_refused_with_the_known_ones(made):
    found = made(ONE)
    with pytest.raises(ValueError, match=r"bending_effort, straightness .*got 'pace'"):
        maps.archive(found, axes=["pace"])
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


def test_a_tessellation_is_drawn_as_its_cells_with_elites_in_colour(made):
    centroids = np.random.default_rng(5).random((12, 2))
    elites = [{"cell": 3, "fitness": 1.0}, {"cell": 8, "fitness": 4.0}]
    found = made(elites, centroids=centroids)
    everything, filled = maps.archive(found).axes[0].collections
    assert (len(everything.get_paths()), len(filled.get_paths())) == (12, 2)
    np.testing.assert_array_equal(filled.get_array(), [1.0, 4.0])
    x, _ = chosen(found, None)
    corners = filled.get_paths()[0].vertices[:, 0]
    place = x.places(corners)
    assert place.min() <= centroids[3, 0] <= place.max()


@pytest.fixture
def found(made):
    elites = [{"cell": cell, "fitness": cell / 2} for cell in (0, 3, 9, 17)]
    return made(elites, seed=4, world={"width": 48, "height": 48, "viscosity": 0.2})


def drawn(found, suffix, monkeypatch, when):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", str(when))
    text = caption.of_archive(found, None)
    return style.encoded(maps.archive(found), suffix, caption=text)


@pytest.mark.parametrize("suffix", [".pdf", ".svg", ".png"])
def test_the_same_archive_gives_the_same_bytes_at_any_time(found, suffix, monkeypatch):
    first = drawn(found, suffix, monkeypatch, 0)
    monkeypatch.delenv("SOURCE_DATE_EPOCH")
    monkeypatch.setattr(time, "time", lambda: 2e9)
    assert drawn(found, suffix, monkeypatch, 10**9) == first


def test_a_form_that_is_not_force_free_is_said_to_be(made):
    paper = {"projection": "none", "theta_feedback": 0}
    text = caption.of_archive(made(ONE, coupling=paper, search={"feasible": False}), None)
    assert "(coupling not force-free)" in text


@pytest.mark.parametrize(
    ("fitness", "world", "said", "label"),
    [
        ("cost_of_transport", {}, "minus the work on the fluid", "−Cost of transport"),
        ("upstream", {"flow": {"kind": "poiseuille"}}, "the speed along −x", "−Advance"),
        ("through", {"obstacles": [{"x": 20, "y": 8}]}, "the speed along x", "Advance"),
    ],
)
def test_caption_and_colour_bar_state_the_fitness(made, fitness, world, said, label):
    found = made(ONE, task={"fitness": fitness}, world=world)
    assert f"Fitness is {said}" in caption.of_archive(found, None)
    assert reading.fitness_label(found).startswith(label)


def test_latex_escapes_every_letter_that_means_something():
    text = latex("64.8 % of 3 × 4 & x_1^2 #5 {ν} \\ ~ $ cells²")
    assert text == (
        r"64.8\,\% of 3 $\times$ 4 \& x\_1\textasciicircum{}2 \#5 \{$\nu$\} "
        r"\textbackslash{} \textasciitilde{} \$ cells$^2$"
    )
    assert not re.search(r"(?<!\\)[%&#_]", text)


def test_a_published_figure_has_its_caption_beside_it_and_below(found, tmp_path):
    text, figure = caption.of_archive(found, None), maps.archive(found)
    high = figure.get_size_inches()[1]
    written = style.publish(figure, tmp_path / "map.svg", text, under=True, tex=True)
    assert [path.name for path in written] == ["map.svg", "map.caption.txt", "map.caption.tex"]
    assert written[1].read_text() == text + "\n"
    assert r"$\nu$ = 0.2" in written[2].read_text()
    assert figure.get_size_inches()[1] > high
    assert "Archive of 4 elites" in written[0].read_text()
    with pytest.raises(ValueError, match=r"must end in \.pdf"):
        style.publish(figure, tmp_path / "map.bmp", text)
