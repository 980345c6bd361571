"""A search of your own: `ask` and `tell` on any evaluation function."""

import re

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import search
from microcosmos.device import array
from microcosmos.genomes import Vector
from microcosmos.search import emitters

BOUNDS = (-5.0, 15.0)
SPACE = search.Vectors(4, *BOUNDS)
GRID = search.Grid(tuple(search.Axis(i, *BOUNDS, bins=6) for i in range(2)))
AROUND = search.voronoi(GRID.axes, np.random.default_rng(0).random((20, 2)).astype("f4"))


def evaluated(vectors):
    """A square with its top at 4, and the first two arguments as measures."""
    return 500 - np.sum((vectors - 4) ** 2, 1), vectors[:, :2]


def vector_emitters(cells):
    line = emitters.IsoLine(8, SPACE, iso=0.05, line=0.2, select="curiosity")
    return [line, emitters.CmaMae(12, SPACE, cells.count, 0.2, 0.1, 0.0, emitters=2)]


def on_vectors(cells=GRID, seed=0):
    return search.Search(SPACE, cells, vector_emitters(cells), seed=seed)


def advanced(loop, generations):
    for _ in range(generations):
        loop.tell(*evaluated(loop.ask()))
    return loop


@pytest.mark.long
def test_the_archive_is_that_of_a_plain_loop_over_cells():
    loop, best = on_vectors(), {}
    for _ in range(12):
        vectors = loop.ask()
        fitness, measures = evaluated(vectors)
        loop.tell(fitness, measures)
        bins = np.clip((measures + 5) / (20 / 6), 0, 5).astype(int)
        for row, (i, j) in enumerate(bins):
            cell = 6 * int(i) + int(j)
            if cell not in best or fitness[row] > best[cell][0]:
                best[cell] = fitness[row], vectors[row]
    elites = loop.elites
    assert elites.cell.tolist() == sorted(best)
    np.testing.assert_array_equal(elites.fitness, [best[i][0] for i in sorted(best)])
    np.testing.assert_array_equal(elites.genotypes, [best[i][1] for i in sorted(best)])
    np.testing.assert_allclose(loop.qd_score, sum(float(f) for f, _ in best.values()))
    assert loop.coverage == pytest.approx(len(best) / 36)
    fittest = max(best.values(), key=lambda one: one[0])
    np.testing.assert_array_equal(loop.best.genotypes, fittest[1])
    assert (loop.generation, loop.evaluations, loop.infeasible) == (12, 240, 0)


@pytest.mark.parametrize("cells", [GRID, AROUND], ids=["grid", "cvt"])
def test_a_restored_search_continues_with_the_same_bytes_after_any_generation(cells):
    whole, files = on_vectors(cells), []
    for _ in range(6):
        files.append(whole.save())
        whole.ask()
        assert whole.save() == files[-1]  # An unanswered ask leaves no trace.
        advanced(whole, 1)
    again = on_vectors(cells)
    for generation, data in enumerate(files):
        again.restore(data)
        assert again.generation == generation
        assert advanced(again, 6 - generation).save() == whole.save()


def test_ask_gives_the_same_rows_until_they_are_told_and_others_for_another_seed():
    loop = on_vectors()
    first = loop.ask()
    np.testing.assert_array_equal(loop.ask(), first)
    loop.tell(*evaluated(first))
    assert not np.array_equal(loop.ask(), first)
    assert not np.array_equal(on_vectors(seed=1).ask(), first)


def test_vectors_lie_within_bounds_of_their_own_and_both_scales_agree():
    low, high = np.array([0.0, -1.0, 10.0]), np.array([0.1, 1.0, 30.0])
    space = search.Vectors(3, low, high)
    emitter = emitters.IsoLine(500, space, iso=2.0)
    loop = search.Search(space, search.Grid((search.Axis(0, 0.0, 0.1, 3),)), [emitter])
    for _ in range(2):
        vectors = loop.ask()
        assert (vectors >= np.float32(low)).all()
        assert (vectors <= np.float32(high)).all()
        loop.tell(vectors.sum(1), vectors[:, :1])
    ends = Vector(jnp.asarray([[-1.0, 0.0, 1.0]]))
    for genotypes in (ends, jax.device_get(ends)):
        decoded = space.decode(genotypes)
        np.testing.assert_allclose(decoded, [[0.0, 0.0, 30.0]], atol=1e-6)


def test_a_compiled_run_finds_what_ask_and_tell_find():
    def function(vector):
        return 500 - jnp.sum((vector - 4) ** 2), vector[:2]

    parts, whole, asked = on_vectors(), on_vectors(), advanced(on_vectors(), 30)
    for generations in (1, 10, 19):
        parts.run(function, generations)
    whole.run(function, 30)
    assert parts.save() == whole.save()
    assert whole.generation == 30
    # Rounding differs, and so the course of the search.
    assert whole.coverage == pytest.approx(asked.coverage, abs=0.15)
    assert whole.best.fitness == pytest.approx(asked.best.fitness, abs=5)


def test_what_is_not_finite_or_not_feasible_is_counted_and_never_enters():
    loop = on_vectors()
    vectors = loop.ask()
    fitness, measures = evaluated(vectors)
    fitness[0], fitness[1], measures[2, 0], measures[3, 1] = np.nan, np.inf, np.nan, -np.inf
    fitness = fitness.astype(float)
    fitness[4] = 1e300  # Beyond single precision.
    inserted = loop.tell(fitness, measures, feasible=np.arange(20) != 5)
    assert not inserted.entered[:6].any()
    assert inserted.entered[6:].any()
    assert loop.infeasible == 6
    assert np.isfinite(loop.elites.fitness).all()
    again = loop.ask()
    assert np.isfinite(again).all()
    loop.tell(np.full(20, np.nan), np.zeros((20, 2)))
    assert loop.infeasible == 26
    assert np.isfinite(loop.ask()).all()


def test_an_empty_search_has_no_best_and_a_score_of_zero():
    loop = on_vectors()
    assert loop.best is None
    assert (loop.qd_score, loop.coverage, len(loop.elites.cell)) == (0.0, 0.0, 0)


def test_further_measures_are_recorded_beside_those_of_the_axes():
    axis = search.Axis(measure=1, low=0.0, high=1.0, bins=4)
    emitter = emitters.Random(6, SPACE)
    loop = search.Search(SPACE, search.Grid((axis,)), [emitter], measures=3)
    loop.ask()
    measures = np.array([[np.nan, i / 6, 7.0] for i in range(6)])
    loop.tell(np.arange(6.0), measures)
    assert loop.elites.fitness.tolist() == [1, 2, 4, 5]
    assert (loop.elites.measures[:, 2] == 7).all()
    assert loop.infeasible == 0


def outputs_at(points):
    networks = search.Networks(2, 1)
    one = jax.tree.map(lambda x: x[None], networks(key=jax.random.key(0)))
    return networks.outputs_of(one, points)


ASKED = np.zeros(20), np.zeros((20, 2))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ((ASKED[0][:19], ASKED[1]), "`fitness` must have shape (20,), got (19,)"),
        ((ASKED[0], ASKED[1][:, :1]), "`measures` must have shape (20, 2), got (20, 1)"),
        ((*ASKED, [True]), "`feasible` must have shape (20,), got (1,)"),
    ],
)
def test_outcomes_of_another_shape_are_refused_and_can_be_told_again(given, message):
    loop = on_vectors()
    loop.ask()
    with pytest.raises(ValueError, match=re.escape(message)):
        loop.tell(*given)
    loop.tell(*ASKED)
    assert loop.generation == 1


def test_tell_before_ask_is_refused():
    with pytest.raises(ValueError, match="`tell` must follow `ask`"):
        on_vectors().tell(*ASKED)


@pytest.mark.parametrize(
    ("other", "message"),
    [
        (lambda: on_vectors(seed=3), "`seed` must be the file's, 0, got 3"),
        (lambda: on_vectors(AROUND), "`container` must be the file's"),
        (
            lambda: search.Search(SPACE, GRID, vector_emitters(GRID)[:1]),
            "`emitters` must be the file's",
        ),
        (
            lambda: search.Search(search.Vectors(4), GRID, vector_emitters(GRID)),
            "`space` must be the file's",
        ),
    ],
)
def test_the_file_of_another_search_is_refused(other, message):
    data = on_vectors().save()
    with pytest.raises(ValueError, match=message):
        other().restore(data)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: search.Vectors(0), "`genes` must be at least 1, got 0"),
        (lambda: search.Vectors(2, [0.0], 1.0), "`low` must be a finite number, or 2 of them"),
        (lambda: search.Vectors(2, 1.0, [2.0, 1.0]), "`low` must be below `high`"),
        (lambda: search.Networks(2, 3, nodes=4), "`nodes` must be at least 5, got 4"),
        (lambda: search.Search(SPACE, GRID, []), "`emitters` must hold at least one"),
        (
            lambda: search.Search(SPACE, GRID, [emitters.CmaMega(4, SPACE, 3)]),
            "`emitters` must do without derivatives .* CmaMega",
        ),
        (
            lambda: search.Search(SPACE, GRID, vector_emitters(GRID), measures=1),
            "`measures` must be at least 2, got 1",
        ),
        (
            lambda: outputs_at(np.zeros((4, 3))),
            "`points` must be rows of 2 inputs",
        ),
    ],
)
def test_arguments_that_do_not_fit_are_named(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_the_order_of_arrival_of_slots_does_not_matter():
    """Candidates keep their slots; only rows of the batch change places."""
    vectors = on_vectors().ask()
    fitness, measures = evaluated(vectors)
    fitness = np.round(fitness / 50) * 50  # Many are equal.
    rows = search.candidates(
        1,
        Vector(array(vectors)),
        *map(array, (fitness, measures)),
        array(np.ones(20, bool)),
    )
    order = np.random.default_rng(1).permutation(20)
    nobody = search.no_elites(GRID.count, 2, Vector(array(np.zeros(4))))
    shuffled = jax.tree.map(lambda x: np.asarray(x)[order], rows)
    insert = jax.jit(search.insert)
    one, other = (insert(nobody, given, GRID)[0] for given in (rows, shuffled))
    for a, b in zip(jax.tree.leaves(one), jax.tree.leaves(other), strict=True):
        assert np.asarray(a).tobytes() == np.asarray(b).tobytes()
