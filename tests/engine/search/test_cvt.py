"""Centroidal Voronoi tessellations."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from microcosmos.search import cvt


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    """Nothing is kept beyond a test."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path


def mean_square(centroids):
    """Of the distance of uniform places to their centroid, in areas of a cell."""
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


def test_on_one_axis_cells_are_equal_intervals():
    found = np.sort(cvt.lloyd(10, 1, seed=0)[:, 0])
    np.testing.assert_allclose(found, (np.arange(10) + 0.5) / 10, atol=0.02)


def test_the_same_numbers_give_the_same_centroids_and_others_others():
    one = cvt.lloyd(50, 3, seed=1)
    assert np.array_equal(one, cvt.lloyd(50, 3, seed=1))
    assert not np.array_equal(one, cvt.lloyd(50, 3, seed=2))
    assert ((one >= 0) & (one <= 1)).all()


def test_centroids_are_kept_on_disk_and_damage_is_noticed(cache, monkeypatch):
    first = cvt.centroids(20, 2, seed=0)
    (path,) = cache.rglob("*.npy")
    assert path.stem == cvt.name(20, 2, 0)
    with monkeypatch.context() as patch:
        patch.setattr(cvt, "lloyd", None)
        assert np.array_equal(cvt.centroids(20, 2, seed=0), first)
    path.write_bytes(path.read_bytes()[:100])
    assert np.array_equal(cvt.centroids(20, 2, seed=0), first)


def test_a_folder_that_cannot_be_written_costs_time_only(tmp_path, monkeypatch):
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked))
    assert cvt.centroids(5, 2, seed=0).shape == (5, 2)
