"""Cells: bins of a grid, nearest centroids, and Voronoi tessellations."""

import jax
import numpy as np
import pytest
from scipy.spatial import cKDTree

from microcosmos import search
from microcosmos.device import array
from microcosmos.search import cvt

AXES = (
    search.Axis(measure=0, low=1e-4, high=1e2, bins=6, logarithmic=True),
    search.Axis(measure=1, low=0.0, high=1.0, bins=4, logarithmic=False),
)


cells_of = jax.jit(lambda cells, places: cells.of(places))


def unit(axes):
    return tuple(search.Axis(i, 0.0, 1.0, 4, False) for i in range(axes))


def test_bins_are_half_open_and_their_ends_are_counted():
    place = jax.jit(AXES[1].bin)(np.float32([-1.0, 0.0, 0.2499, 0.25, 0.999, 1.0, 7.0]))
    assert place.tolist() == [0, 0, 0, 1, 3, 3, 3]
    place = jax.jit(AXES[0].bin)(np.float32([0.0, 1e-4, 1.01e-3, 1.0, 99.0, 1e2, 1e9]))
    assert place.tolist() == [0, 0, 1, 4, 5, 5, 5]


@pytest.mark.parametrize(
    ("low", "high", "edges"),
    [
        (1e-4, 1e2, [1e-3, 1e-2, 1e-1, 1e0, 1e1]),
        (0.05, 50.0, [0.5, 5.0]),
        (1e-7, 1e3, [10.0**power for power in range(-6, 3)]),
        (0.5, 512.0, [2.0**power for power in range(9)]),
    ],
)
def test_a_value_on_an_edge_of_a_logarithmic_bin_is_in_the_upper_one(low, high, edges):
    axis = search.Axis(0, low, high, len(edges) + 1, logarithmic=True)
    on = np.array(edges, np.float32)
    assert np.array_equal(axis.edges, on)
    below = np.nextafter(on, np.float32(0))
    for compiled in (axis.bin, jax.jit(axis.bin)):
        assert compiled(array(on)).tolist() == list(range(1, len(edges) + 1))
        assert compiled(array(below)).tolist() == list(range(len(edges)))


@pytest.mark.parametrize("axes", [1, 2, 3, 5, 8])
def test_a_grid_of_any_dimension_is_numbered_as_numpy_numbers_arrays(axes):
    grid = search.Grid(tuple(search.Axis(i, 0.0, 1.0, 2 + i % 2, False) for i in range(axes)))
    shape = tuple(axis.bins for axis in grid.axes)
    places = np.random.default_rng(axes).random((200, axes)).astype(np.float32)
    expected = np.ravel_multi_index(tuple((places * shape).astype(int).T), shape)
    assert np.array_equal(cells_of(grid, places), expected)
    centres = np.asarray(grid.centres, np.float32)
    assert np.array_equal(cells_of(grid, centres), np.arange(grid.count))


@pytest.mark.parametrize(("count", "axes"), [(2, 1), (50, 1), (300, 2), (500, 3), (60, 6)])
def test_the_nearest_centroid_is_found(count, axes):
    random = np.random.default_rng(count)
    around = random.random((count, axes)).astype(np.float32)
    places = random.uniform(-0.1, 1.1, (500, axes)).astype(np.float32)
    near = np.asarray(cells_of(search.voronoi(unit(axes), around), places))
    inside = np.clip(places, 0, 1).astype(float)
    distance = ((inside[:, None] - around[None].astype(float)) ** 2).sum(2)
    best = distance.min(1)
    np.testing.assert_allclose(distance[np.arange(500), near], best, rtol=0, atol=1e-6)
    clear = np.sort(distance, 1)[:, 1] - best > 1e-5
    assert clear.mean() > 0.8
    assert np.array_equal(np.asarray(near)[clear], distance.argmin(1)[clear])


def test_lists_of_candidates_find_what_looking_at_all_finds():
    around = np.random.default_rng(5).random((4096, 2)).astype(np.float32)
    listed = search.voronoi(unit(2), around)
    assert listed.near is not None
    everywhere = search.Voronoi(listed.axes, listed.centroids, None)
    places = np.random.default_rng(6).random((2000, 2)).astype(np.float32)
    assert np.array_equal(cells_of(listed, places), cells_of(everywhere, places))


@pytest.mark.parametrize("listed", [True, False])
def test_the_first_of_equally_near_centroids_is_chosen(listed):
    around = np.array([[0.75, 0.5], [0.25, 0.5], [0.25, 0.5], [0.5, 1.0]], np.float32)
    found = search.voronoi(unit(2), around)
    if not listed:
        found = search.Voronoi(found.axes, found.centroids, None)
    places = np.float32([[0.5, 0.5], [0.1, 0.5], [0.25, 0.5]])
    assert cells_of(found, places).tolist() == [0, 1, 1]


def test_distances_are_measured_on_the_axes_own_scales():
    around = np.array([[0.5, 0.5], [0.9, 0.5]], np.float32)  # 10^-1 and 10^1.4.
    places = np.float32([[0.1, 0.5], [20.0, 0.5], [4.0, 0.5]])
    assert cells_of(search.voronoi(AXES, around), places).tolist() == [0, 1, 1]


@pytest.mark.parametrize(
    "around",
    [np.zeros((1, 2)), np.zeros((5, 3)), np.full((5, 2), 1.5), np.full((5, 2), np.nan)],
)
def test_centroids_that_fit_nothing_are_refused(around):
    with pytest.raises(ValueError, match="`centroids` must be"):
        search.voronoi(unit(2), around)


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path


def mean_square(centroids):
    """Mean squared distance of uniform points to their centroid, in areas of a cell."""
    places = np.random.default_rng(9).random((200_000, centroids.shape[1]))
    power = 2 / centroids.shape[1]
    return (cKDTree(centroids).query(places)[0] ** 2).mean() * len(centroids) ** power


def test_cells_are_nearly_as_compact_as_hexagons():
    hexagons, squares = 5 / (18 * np.sqrt(3)), 1 / 6
    found = mean_square(cvt.centroids(1000, 2, seed=0))
    assert hexagons < found < 1.08 * hexagons
    assert found < 1.05 * squares


def test_centroids_lie_at_the_means_of_their_cells():
    found = cvt.centroids(64, 2, seed=3)
    places = np.random.default_rng(1).random((400_000, 2))
    near = cKDTree(found).query(places)[1]
    means = np.stack([np.bincount(near, x, 64) for x in places.T], 1)
    means /= np.bincount(near, minlength=64)[:, None]
    assert np.abs(means - found).max() < 0.1 / 8  # A tenth of a cell's width.


def test_centroids_are_kept_on_disk_and_damage_is_noticed(cache, monkeypatch):
    first = cvt.centroids(20, 2, seed=0)
    (path,) = cache.rglob("*.npy")
    assert path.stem == cvt.name(20, 2, 0)
    with monkeypatch.context() as patch:
        patch.setattr(cvt, "lloyd", None)
        assert np.array_equal(cvt.centroids(20, 2, seed=0), first)
    path.write_bytes(path.read_bytes()[:100])
    assert np.array_equal(cvt.centroids(20, 2, seed=0), first)
