"""A search of your own: `ask` and `tell` on any evaluation function."""

import re
from fractions import Fraction

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import neat, search
from microcosmos.genomes import Vector
from microcosmos.search import emitters
from microcosmos.search.qdax import QdaxEmitter

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


NETWORKS, PAPER = search.Networks(2, 1), neat.PRESETS["paper"]
OTHER = search.Grid(GRID.axes[::-1])


def of_qdax(cells):
    return QdaxEmitter(4, SPACE, cells, None, "cma-me")


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
        *(
            ((*ASKED, feasible), "`feasible` must be true or false, got")
            for feasible in ([np.nan] * 20, ["False"] * 20, [-1, 2] * 10, [None] * 20)
        ),
        *(
            ((fitness, ASKED[1]), "`fitness` must be real numbers, got")
            for fitness in (
                np.ma.array(ASKED[0], mask=True),
                ASKED[0] + 3j,
                np.full(20, "2020-01-01", "M8[D]"),
                ["1"] * 20,
                [10**400] * 20,
                [Fraction(10**400)] * 20,
            )
        ),
        ((ASKED[0], [[0.0]] * 19 + [[0.0, 1.0]]), "`measures` must have rows of one length"),
    ],
)
def test_outcomes_of_another_shape_are_refused_and_can_be_told_again(given, message):
    loop = on_vectors()
    loop.ask()
    with pytest.raises(ValueError, match=re.escape(message)):
        loop.tell(*given)
    loop.tell(*ASKED)
    assert loop.generation == 1


@pytest.mark.parametrize(
    "function",
    [
        lambda x: (x[0], x[:1]),
        lambda x: (x[0], x[0]),
        lambda x: (x, x[:2]),
        lambda x: x[0],
        lambda x: (x[0] + 1j, x[:2]),
    ],
)
def test_a_function_of_another_shape_is_refused(function):
    loop = on_vectors()
    with pytest.raises(ValueError, match="`function` must return a real fitness"):
        loop.run(function, 1)
    with pytest.raises(ValueError, match="`generations` must be a whole number, at least 0"):
        loop.run(function, -1)
    assert loop.generation == 0


class Stopped(BaseException):
    """As Ctrl-C during a compilation."""


@pytest.mark.parametrize("moment", ["emit", "tell"])
def test_a_generation_that_fails_is_asked_for_again(moment):
    class Fails(emitters.IsoLine):
        def emit(self, *given, **keys):
            return fails("emit") or super().emit(*given, **keys)

        def tell(self, *given):
            return fails("tell") or super().tell(*given)

    def fails(now):
        if now == moment and not failed:
            failed.append(now)
            raise Stopped

    failed = []
    loop = search.Search(SPACE, GRID, [Fails(20, SPACE, 0.1)])
    with pytest.raises(Stopped):
        loop.tell(*evaluated(loop.ask()))
    with pytest.raises(ValueError, match="`tell` must follow `ask`"):
        loop.tell(*ASKED)
    whole = search.Search(SPACE, GRID, [emitters.IsoLine(20, SPACE, 0.1)])
    np.testing.assert_array_equal(advanced(loop, 1).ask(), advanced(whole, 1).ask())
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
        (lambda: search.Vectors(0), "`genes` must be a whole number, at least 1; got 0"),
        (lambda: search.Vectors(2, [0.0], 1.0), "`low` must be a finite number, or 2 of them"),
        (lambda: search.Vectors(2, [[0.0], [0.0, 1.0]]), "`low` must have rows of one length"),
        (lambda: search.Vectors(2, 1.0, [2.0, 1.0]), "`low` must be below `high`"),
        (
            lambda: search.Networks(2, 3, nodes=4),
            "`nodes` must be .* at least 5; got 4",
        ),
        (lambda: search.Search(SPACE, GRID, []), "`emitters` must hold at least one"),
        *(
            (
                lambda seed=seed: search.Search(SPACE, GRID, vector_emitters(GRID), seed=seed),
                "`seed`",
            )
            for seed in (-1, 2**32, 2**40)
        ),
        (
            lambda: search.Search(SPACE, GRID, [emitters.CmaMega(4, SPACE, 3)]),
            "`emitters` must do without derivatives, got CmaMega",
        ),
        *(
            (
                lambda emitter=emitter: search.Search(NETWORKS, GRID, [emitter]),
                f"`emitters` must vary genotypes of .* got {name}, which varies vectors",
            )
            for name, emitter in {
                "IsoLine": emitters.IsoLine(4, NETWORKS, 0.1),
                "CmaMae": emitters.CmaMae(4, NETWORKS, 36, 0.2, 0.1, 0.0),
            }.items()
        ),
        *(
            (
                lambda emitter=emitter: search.Search(SPACE, GRID, [emitter]),
                f"`emitters` must vary genotypes of .* got {name}, which varies networks",
            )
            for name, emitter in {
                "Neat": emitters.Neat(4, SPACE, PAPER.rates, 2),
                "PopulationNeat": emitters.PopulationNeat(4, SPACE, PAPER, 2, 1),
            }.items()
        ),
        (
            lambda: search.Search(NETWORKS, GRID, [emitters.Neat(4, NETWORKS, PAPER.rates, 1)]),
            "`emitters` must have the inputs of the search's space, 2; got Neat of 1",
        ),
        (
            lambda: search.Search(
                NETWORKS, GRID, [emitters.PopulationNeat(4, NETWORKS, PAPER, 2, 3)]
            ),
            "`emitters` must have the outputs of .*, 1; got PopulationNeat of 3",
        ),
        (
            lambda: search.Search(SPACE, GRID, vector_emitters(AROUND)),
            "`emitters` must learn from the 36 cells of the search; got CmaMae of 20 others",
        ),
        (
            lambda: search.Search(SPACE, GRID, [of_qdax(OTHER)]),
            "from the 36 cells of the search; got QdaxEmitter of 36 others",
        ),
        *(
            (
                lambda container=container: search.Search(
                    SPACE, container, vector_emitters(GRID)
                ),
                f"`emitters` must not learn from cells with {type(container).__name__}",
            )
            for container in (
                search.DominatedNovelty(GRID, size=36),
                search.Fronts(GRID, search.Axis(1, 0.0, 1.0, 1), size=2),
                search.learned_axes(GRID, (0, 1)),
            )
        ),
        (
            lambda: search.Search(SPACE, GRID, vector_emitters(GRID), measures=1),
            "`measures` must be a whole number, at least 2; got 1",
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
