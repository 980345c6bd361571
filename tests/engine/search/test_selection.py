"""Selection of parents: their chances, and the curiosity of elites."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import search
from microcosmos.genomes import Vector
from microcosmos.search import emitters
from microcosmos.search.emitters.selection import draw, ends

CELLS = 5
ELITES = (4, 0, 2)
"""Occupied cells, in the order of their fitness."""
TOURNAMENTS = np.diff(np.array([0.0, 1 / 3, 2 / 3, 1.0]) ** 3)
"""Shares of the elites among the fittest of three draws."""


@pytest.fixture
def elites():
    empty, place = search.no_elites(CELLS, 1, Vector(jnp.zeros(1))), jnp.asarray(ELITES)
    return replace(
        empty,
        occupied=empty.occupied.at[place].set(True),
        fitness=empty.fitness.at[place].set(jnp.array([-1.0, 0.5, 2.0])),
        curiosity=empty.curiosity.at[place].set(1.0),
    )


def with_scores(elites, *scores):
    """The elites with these scores, in the order of their fitness."""
    return replace(elites, curiosity=jnp.zeros(CELLS).at[jnp.array(ELITES)].set(scores))


def credited(elites, parents, cell, entered):
    entered = jnp.asarray(entered)
    inserted = search.Inserted(jnp.asarray(cell), entered, entered, jnp.zeros(len(entered)))
    return emitters.credit(elites, jnp.asarray(parents), inserted)


def shares_of(elites, select):
    keys = jax.random.split(jax.random.key(0), 4000)
    found = jax.jit(jax.vmap(lambda key: draw(elites, select, key=key)))(keys)
    shares = np.bincount(found, minlength=CELLS) / len(keys)
    assert shares[[1, 3]].sum() == 0  # Empty cells.
    return shares[list(ELITES)]


@pytest.mark.parametrize(
    ("select", "won"), [("uniform", 0.0), ("mixed", 0.5), ("tournament", 1.0)]
)
def test_parents_are_drawn_by_the_chosen_selection(elites, select, won):
    expected = (1 - won) / 3 + won * TOURNAMENTS
    np.testing.assert_allclose(shares_of(elites, select), expected, atol=0.03)


def test_equally_fit_elites_are_drawn_equally_often(elites):
    equal = replace(elites, fitness=elites.fitness.at[ELITES[1]].set(2.0))
    expected = [1 / 27, 13 / 27, 13 / 27]
    np.testing.assert_allclose(shares_of(equal, "tournament"), expected, atol=0.03)


def test_curiosity_multiplies_the_chances_of_parents(elites):
    shares = shares_of(with_scores(elites, 3.0, 0.5, 1.0), "curiosity")
    expected = (1 / 6 + TOURNAMENTS / 2) * [3, 0.5, 1]
    np.testing.assert_allclose(shares, expected / expected.sum(), atol=0.03)


@pytest.mark.parametrize("select", ["uniform", "mixed", "tournament", "curiosity"])
def test_no_number_draws_an_empty_cell(select):
    """A sum in another order rounds to other ends at some of so many empty cells."""
    random, cells = np.random.default_rng(0), 4096
    occupied = random.random(cells) < 0.3
    sparse = replace(
        search.no_elites(cells, 1, Vector(jnp.zeros(1))),
        occupied=jnp.asarray(occupied),
        fitness=jnp.asarray(random.random(cells), jnp.float32),
        curiosity=jnp.asarray(0.05 + random.integers(0, 9, cells) / 2, jnp.float32),
    )
    found = jax.jit(ends, static_argnums=1)(sparse, select)
    lengths = np.diff(found, prepend=0)
    assert np.all(lengths >= 0)
    assert np.all(lengths[~occupied] == 0)


def test_an_empty_archive_gives_the_first_cell(elites):
    empty = replace(elites, occupied=jnp.zeros(CELLS, bool))
    for select in ("uniform", "mixed", "tournament", "curiosity"):
        assert int(draw(empty, select, key=jax.random.key(1))) == 0


def test_parents_gain_by_children_that_enter_and_lose_by_others(elites):
    elites = with_scores(elites, 0.25, 1.0, 2.0)
    occupied = elites.occupied.at[1].set(True)  # By the first child.
    # The third child replaces its own parent, and the sixth, a newcomer, another elite.
    parents, cell = [0, 0, 2, 2, 4, 5, search.NO_PARENT], [1, 0, 2, 5, 5, 4, 5]
    entered = [True, False, True, False, False, True, False]
    found = credited(replace(elites, occupied=occupied), parents, cell, entered)
    assert found.tolist() == [1.5, 1.0, 1.0, 0.0, 1.0]


def test_the_curiosity_of_parents_has_a_least_value(elites):
    elites = with_scores(elites, 0.25, 1.0, 2.0)
    found = credited(elites, [0, 0, 2, 2, 4], [5] * 5, [False] * 5)
    np.testing.assert_allclose(found, [0.05, 0, 1, 0, 0.05], rtol=1e-6)


def test_curiosity_does_not_depend_on_the_order_of_children(elites):
    random = np.random.default_rng(0)
    parents, entered = random.integers(0, CELLS, 40), random.random(40) < 0.4
    elites, nowhere = with_scores(elites, 0.05, 0.3, 0.7), np.full(40, CELLS)
    orders = [random.permutation(40) for _ in range(20)]
    found = [credited(elites, parents[order], nowhere, entered[order]) for order in orders]
    assert len({np.asarray(one).tobytes() for one in found}) == 1
