"""Pareto fronts beside the written rule, and their figures beside closed forms."""

from dataclasses import replace

import jax
import numpy as np
import pytest
from elite_rows import AWKWARD, AXES, awkward, candidates

from microcosmos import genomes, search
from microcosmos.device import array
from microcosmos.search import insertion
from microcosmos.search.cvt import centroids

COST = search.Axis(measure=2, low=1.0, high=1e3, bins=1, logarithmic=True)
GRID = search.Grid(AXES)
AROUND = search.voronoi(AXES, centroids(9, 2, seed=0))

insert = jax.jit(search.insert)
survivors = jax.jit(lambda fronts, rows, position: fronts.survivors(rows, position))
crowding_distance = jax.jit(search.crowding_distance)


def vectors(random, count):
    return genomes.Vector(array(random.normal(size=(count, 3)), np.float32))


def pool(seed, count=120, kind=candidates, levels=5):
    """Rows with a third measure, in which equal objectives, NaN and infinities are common."""
    rows, random = kind(vectors, count, seed, levels=levels), np.random.default_rng(seed)
    cost = 10.0 ** random.integers(0, 6, count)
    odd = random.random(count) < 0.2
    cost[odd] = random.choice(AWKWARD, odd.sum())
    measures = np.concatenate([rows.measures, cost.astype(np.float32)[:, None]], 1)
    return replace(rows, measures=array(measures))


def all_of(fitness, measures):
    """Rows of distinct genomes that are all feasible."""
    count = len(fitness)
    given = (array(x, np.float32) for x in (fitness, measures))
    genotypes = vectors(np.random.default_rng(0), count)
    return search.candidates(1, genotypes, *given, array(np.ones(count, bool)))


def odd_pool(seed, count=120):
    return pool(seed, count, lambda *given, levels: awkward(*given))


def objectives(rows, fronts):
    first, second = np.asarray(rows.fitness), np.asarray(rows.measures)[:, 2]
    return first, -second if fronts.least else second


def cells_of(fronts, measures):
    return fronts.cells.of(measures)


def on_fronts(rows, position, fronts):
    """The rows that no other of their cell beats, one after another."""
    first, second = objectives(rows, fronts)
    cell = np.asarray(jax.jit(cells_of)(fronts, rows.measures))
    able = np.flatnonzero(np.asarray(rows.occupied) & np.isfinite(second))

    def beats(j, i):
        as_good = first[j] >= first[i] and second[j] >= second[i]
        better = first[j] > first[i] or second[j] > second[i] or position[j] < position[i]
        return cell[j] == cell[i] and as_good and better

    kept = np.zeros(len(first), bool)
    kept[[i for i in able if not any(beats(j, i) for j in able if j != i)]] = True
    return kept, cell


def crowding(first, place):
    """The crowding distance of a front that is sorted by its first objective."""
    distance = np.full(len(first), np.inf)
    for i in range(1, len(first) - 1):
        parts = (abs(x[i + 1] - x[i - 1]) / abs(x[0] - x[-1]) for x in (first, place))
        distance[i] = sum(parts)
    return distance


@jax.jit
def ranked(rows, fronts):
    """Occupied rows that are sound, and each one's position in the total order."""
    rows = replace(rows, occupied=insertion.sound(rows, fronts.axes))
    return rows, insertion.ranked(rows)[0]


@pytest.mark.parametrize("cells", [GRID, AROUND], ids=["grid", "cvt"])
@pytest.mark.parametrize("least", [True, False])
@pytest.mark.parametrize("kind", [pool, odd_pool])
def test_no_other_row_of_the_cell_beats_a_survivor(cells, least, kind):
    fronts = search.Fronts(cells, COST, 200, least)
    for seed in range(8):
        rows, position = ranked(kind(seed), fronts)
        expected, _ = on_fronts(rows, np.asarray(position), fronts)
        np.testing.assert_array_equal(survivors(fronts, rows, position), expected)
        assert expected.any()


@pytest.mark.parametrize("size", [2, 3, 5])
def test_of_a_long_front_the_ends_and_the_least_crowded_survive(size):
    fronts = search.Fronts(search.Grid((search.Axis(0, 0.0, 1.0, 2),)), COST, size)
    cut = 0
    for seed in range(10):
        random = np.random.default_rng(seed)
        angle = random.uniform(0, np.pi / 2, 60) * random.uniform(0.8, 1.0, 60)
        fitness, cost = np.cos(angle), 10 ** (3 - 3 * np.sin(angle))
        measures = np.stack([random.random(60), np.zeros(60), cost], 1)
        rows, position = ranked(all_of(fitness, measures), fronts)
        front, cell = on_fronts(rows, np.asarray(position), fronts)
        found = np.asarray(survivors(fronts, rows, position))
        place = np.asarray(jax.jit(COST.place)(np.asarray(rows.measures)[:, 2]))
        for one in range(2):
            own = np.flatnonzero(front & (cell == one))
            own = own[np.argsort(-fitness[own])]
            distance = crowding(fitness[own], place[own])
            order = np.lexsort((np.asarray(position)[own], -distance))
            assert set(own[order[:size]]) == set(np.flatnonzero(found & (cell == one)))
            assert found[own[[0, -1]]].all()
            cut += len(own) > size
    assert cut > 10


@pytest.mark.long
@pytest.mark.parametrize("least", [True, False])
def test_a_front_does_not_depend_on_when_its_elites_came(least):
    fronts = search.Fronts(GRID, COST, 60, least)
    rows = pool(5, 240)
    one = search.no_elites(fronts.count, 3, genomes.Vector(array(np.zeros(3))))
    whole, _ = insert(one, rows, fronts)
    parts = one
    for start in range(0, 240, 40):
        batch = jax.tree.map(lambda x, start=start: np.asarray(x)[start : start + 40], rows)
        parts, _ = insert(parts, batch, fronts)
    slots = (np.sort(np.asarray(x.slot)[np.asarray(x.occupied)]) for x in (whole, parts))
    np.testing.assert_array_equal(*slots)


def test_the_area_under_a_quarter_circle():
    angle = np.linspace(0, np.pi / 2, 20_001)
    cell = np.zeros(len(angle), int)
    found = search.hypervolume(cell, np.cos(angle), np.sin(angle))
    np.testing.assert_allclose(found, np.pi / 4, rtol=2e-4)


def test_areas_of_cells_add_up_whatever_is_dominated_or_below_the_reference():
    cell = np.array([0, 0, 0, 0, 7, 7, 7])
    first = np.array([1.0, 2.0, 1.0, 0.5, 3.0, -1.0, 4.0])
    second = np.array([1.0, 0.5, 0.75, 0.2, 0.5, 0.9, -0.1])
    # Two rectangles that overlap by 1 × 0.5, and one of 3 × 0.5.
    for order in (np.arange(7), np.arange(7)[::-1]):
        given = cell[order], first[order], second[order]
        assert search.hypervolume(*given) == 1.0 + 1.0 - 0.5 + 1.5


@pytest.mark.long
def test_figures_of_an_archive():
    fronts = search.Fronts(GRID, COST, 3)
    measures = [[1e-3, 0.1, 10.0], [1e-3, 0.1, 100.0], [10.0, 0.9, 1.0], [10.0, 0.9, 1e6]]
    rows = all_of([0.25, 0.5, 0.25, 1.0], measures)
    empty = search.no_elites(fronts.count, 3, genomes.Vector(array(np.zeros(3))))
    assert search.front_figures(np.zeros(0), np.zeros((0, 3)), fronts) == (0, 0, 0, 0)
    archive, _ = insert(empty, rows, fronts)
    there = np.asarray(archive.occupied)
    fitness, measures = np.asarray(archive.fitness), np.asarray(archive.measures)
    found = search.front_figures(fitness[there], measures[there], fronts)
    # On the axis from 1,000 to 1 costs of 10 and 100 are at 2/3 and 1/3.
    first_cell = 0.25 * 2 / 3 + 0.25 / 3
    np.testing.assert_allclose(found.moqd_score, first_cell + 0.25)
    np.testing.assert_allclose(found.hypervolume, 0.25 + 0.25 / 3)
    np.testing.assert_allclose(found.largest_sum, 1.25)
    assert found.mean_length == 2
