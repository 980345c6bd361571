"""Public constructors and readers refuse what no search can be, as a spec does."""

import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import search
from microcosmos.bounds import refuse_beyond, refuse_uncountable
from microcosmos.invalid import InvalidField
from microcosmos.neat import Rates
from microcosmos.search import containers, cvt, emitters
from microcosmos.search.emitters.selection import refuse_unknown

SPACE = search.Vectors(3)
RATE = {"weight": 0.6, "weight_step": 1.0, "replace": 0.05, "activation": 0.1, "toggle": 0.02}
RATE |= {"add_node": 0.15, "add_connection": 0.25}
RATES = Rates(**RATE)
NAN, INF = float("nan"), float("inf")
AXIS = {"measure": 0, "low": 0.5, "high": 2.0, "bins": 4, "logarithmic": False}
MAE = {"cells": 16, "step": 0.2, "learning_rate": 0.1, "threshold": 0.0, "emitters": 1}
GRID = search.Grid((search.Axis(0, 0.0, 1.0, 2), search.Axis(1, 0.0, 1.0, 2)))


def mae(**given):
    return emitters.CmaMae(4, SPACE, **(MAE | given))


WRONG = {
    Rates: (
        RATE,
        {"add_node": 1.5},
        {"toggle": NAN},
        {"values": -0.1},
        {"weight_step": INF},
    ),
    search.Axis: (
        AXIS,
        {"low": 2.0, "high": 0.5},
        {"high": 0.5},
        {"low": NAN},
        {"high": INF},
        {"bins": 0},
        {"measure": -1},
        {"low": 0.0, "logarithmic": True},
        {"low": 1e-300, "logarithmic": True},
        {"bins": True},
        {"low": -1e39},
        {"high": 0.5 + 1e-9},
    ),
    emitters.CmaMae: (
        {"slots": 4, "newcomer": SPACE, **MAE},
        {"threshold": -INF},
        {"threshold": NAN},
        {"threshold": 1e39},
        {"learning_rate": -1.0},
        {"learning_rate": 2.0},
        {"step": -0.1},
        {"step": 0.0},
        {"step": 1e39},
        {"cells": 0},
        {"slots": 0},
        {"emitters": True},
    ),
    emitters.CmaMega: (
        {"slots": 4, "newcomer": SPACE, "outputs": 3},
        {"step": 0.0},
        {"rate": NAN},
        {"outputs": 0},
    ),
    emitters.IsoLine: (
        {"slots": 4, "newcomer": SPACE, "iso": 0.1},
        {"iso": NAN},
        {"iso": -0.1},
        {"line": INF},
        {"line": 1e39},
        {"slots": 0},
    ),
    emitters.Neat: (
        {"slots": 4, "newcomer": SPACE, "rates": RATES, "inputs": 3},
        {"crossover": 1.5},
        {"crossover": NAN},
    ),
    containers.DominatedNovelty: (
        {"cells": GRID, "size": 4},
        {"size": 0},
        {"neighbours": 0},
    ),
    search.Grid: (
        {"axes": GRID.axes},
        {"axes": ()},
        {"axes": (search.Axis(0, 0.0, 1.0, 65_536),) * 4},
    ),
    search.Vectors: (
        {"genes": 3},
        {"genes": True},
        {"low": -1e39},
    ),
    search.Networks: (
        {"inputs": 2, "outputs": 1},
        {"nodes": True},
    ),
    containers.learned_axes: (
        {"cells": GRID, "columns": (0, 1)},
        {"columns": (0, -1)},
        {"columns": (0, 0)},
        {"floors": (-1.0, 0.0)},
        {"floors": (NAN, 0.0)},
    ),
    cvt.centroids: (
        {"cells": 2, "axes": 1, "seed": 0},
        {"axes": 0},
        {"seed": -1},
    ),
}


@pytest.mark.fast
@pytest.mark.parametrize("kind", WRONG, ids=lambda kind: kind.__name__)
def test_a_number_beyond_its_bounds_is_refused_by_its_name(kind):
    right, *wrong = WRONG[kind]
    kind(**right)
    for changed in wrong:
        with pytest.raises(InvalidField) as error:
            kind(**right | changed)
        assert error.value.field.split(".")[0] in changed


@pytest.mark.fast
@pytest.mark.parametrize("value", [2.5, True, np.True_, NAN, "3", None, 0, -1, [3]])
def test_a_count_is_a_whole_number(value):
    for count in (1, 2**40, np.int64(3)):
        refuse_uncountable(1, bins=count)
    with pytest.raises(InvalidField, match="`bins` must be a whole number, at least 1; got"):
        refuse_uncountable(1, bins=value)


@pytest.mark.fast
@pytest.mark.parametrize("value", ["0.5", True, np.True_, None, [0.5], NAN, 1.5])
def test_a_share_is_one_real_number(value):
    for share in (0, 1, np.float32(0.5), np.array(0.5), jnp.array(0.5)):
        refuse_beyond(0, 1, share=share)
    with pytest.raises(InvalidField, match="`share` must be at least 0 and at most 1; got"):
        refuse_beyond(0, 1, share=value)


def test_a_selection_that_there_is_not_is_refused():
    with pytest.raises(InvalidField, match="`select` must be one of uniform, mixed,"):
        refuse_unknown("best")


def test_a_search_is_restored_with_the_same_numbers_of_any_kind_only():
    def made(low, axis=GRID.axes[0]):
        grid = search.Grid((axis, GRID.axes[1]))
        return search.Search(
            search.Vectors(3, low, 1.0), grid, [emitters.IsoLine(4, SPACE, 0.1)]
        )

    for one, other in (
        (np.float32(-1), np.float32(-9)),
        (jnp.full(3, -1.0), jnp.full(3, -2.0)),
        (-1.0, -1.5),
    ):
        data = made(one).save()
        made(one).restore(data)
        with pytest.raises(ValueError, match="`space` must be the file's"):
            made(other).restore(data)
    made(-1).restore(made(-1.0).save())
    with pytest.raises(ValueError, match="`axes` must be the file's"):
        made(-1.0, search.Axis(0, 0.0, 2.0, 2)).restore(made(-1.0).save())


class Cube:
    """A space of somebody's own, which is no dataclass."""

    def __init__(self, genes):
        self.genes, self.counters = genes, SPACE.counters

    def __call__(self, *, key):
        return search.Vectors(self.genes)(key=key)

    def decode(self, genotypes):
        return genotypes.values


def test_numbers_and_spaces_of_other_libraries_are_saved():
    def made(space, one=lambda x: x, genes=3):
        grid = search.Grid((search.Axis(1, 0.0, 1.0, 4),))
        emitter = emitters.IsoLine(4, space(genes), 0.1)
        return search.Search(space(genes), grid, [emitter], seed=one(7), measures=one(3))

    for space in (search.Vectors, Cube):
        data = made(space, np.int64).save()
        assert data == made(space).save()
        made(space).restore(data)
    with pytest.raises(ValueError, match="`space` must be the file's"):
        made(Cube, genes=2).restore(data)
    with pytest.raises(ValueError, match=r"`emitters` must be of the search's space"):
        search.Search(search.Vectors(5), GRID, [emitters.IsoLine(4, SPACE, 0.1)])


def test_a_row_without_a_second_objective_is_infeasible():
    fronts = containers.Fronts(GRID, search.Axis(2, 0.0, 1.0, 1), size=2)
    loop = search.Search(SPACE, fronts, [emitters.IsoLine(4, SPACE, 0.1)])
    loop.ask()
    loop.tell(np.ones(4), [[0.1, 0.1, NAN], [0.1, 0.9, 1.0], [0.9, 0.1, INF], [0.9, 0.9, 1.0]])
    assert loop.infeasible == 2
    assert loop.elites.measures[:, 2].tolist() == [1.0, 1.0]


def test_a_second_objective_is_part_of_a_file():
    def made(high):
        fronts = containers.Fronts(GRID, search.Axis(1, 0.0, high, 1), size=2)
        return search.Search(SPACE, fronts, [emitters.IsoLine(4, SPACE, 0.1)])

    made(1.0).restore(made(1.0).save())
    with pytest.raises(ValueError, match="`container` must be the file's"):
        made(2.0).restore(made(1.0).save())


def test_strategies_restart_where_no_child_is_feasible():
    loop = search.Search(SPACE, GRID, [mae(cells=GRID.count)])
    loop.ask()
    loop.tell(np.zeros(4), np.full((4, 2), 0.5), np.zeros(4, bool))
    (state,) = loop._state.emitters
    assert state.restart.all()


def test_more_neighbours_than_rows_are_all_there_are():
    few, many = (containers.DominatedNovelty(GRID, 2, neighbours) for neighbours in (4, 400))
    found = []
    for container in (few, many):
        loop = search.Search(SPACE, container, [emitters.IsoLine(2, SPACE, 0.1)])
        for _ in range(5):
            vectors = loop.ask()
            loop.tell(vectors[:, 0], vectors[:, 1:])
        found.append(loop.elites)
    np.testing.assert_array_equal(*(one.fitness for one in found))
    np.testing.assert_array_equal(*(one.measures for one in found))
