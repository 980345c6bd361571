"""Where children come from: what each emitter draws, and from whom."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import neat, search
from microcosmos.genomes import Vector, minimal
from microcosmos.search import emitters

SLOTS, GENES = 2000, 3


def vector(key):
    return Vector(jax.random.uniform(key, (GENES,), minval=-1.0, maxval=1.0))


def network(key):
    return minimal(key, 3, 2, 8, 12)


@pytest.fixture
def archive():
    """A function that makes an archive of five cells from some elites, the rest empty."""

    def make(genotypes, cells):
        prototype = jax.tree.map(lambda x: x[0], genotypes)
        empty = search.no_elites(5, 1, prototype)
        place = jnp.asarray(cells)
        whole = jax.tree.map(
            lambda old, new: old.at[place].set(new), empty.genotypes, genotypes
        )
        occupied = empty.occupied.at[place].set(True)
        fitness = empty.fitness.at[place].set(jnp.arange(len(cells), dtype=jnp.float32))
        return search.Elites(
            **{**vars(empty), "genotypes": whole, "occupied": occupied, "fitness": fitness}
        )

    return make


def emitted(emitter, archive, seed=0):
    @jax.jit
    def emit(state, archive, counters):
        given = ((emitter,), (state,), archive, counters, jnp.asarray(1))
        return search.emitters.emit(*given, key=jax.random.key(seed))

    state = emitter.init(key=jax.random.key(1))
    children, _, counters = emit(state, archive, neat.first_counters(3, 2))
    return children, counters


def test_a_gaussian_step_has_the_deviation_that_was_asked_for(archive):
    elite = Vector(jnp.asarray([[0.1, -0.2, 0.0]]))
    children, _ = emitted(emitters.IsoLine(SLOTS, vector, iso=0.05), archive(elite, [3]))
    steps = np.asarray(children.genotypes.values) - np.asarray(elite.values)
    np.testing.assert_allclose(steps.std(0), 0.05, rtol=0.06)
    np.testing.assert_allclose(steps.mean(0), 0.0, atol=0.005)
    assert (np.asarray(children.parents) == [3, search.NO_PARENT]).all()


def test_children_of_a_line_lie_along_it(archive):
    ends = jnp.asarray([[0.3, 0.0, 0.0], [-0.3, 0.0, 0.0]])
    emitter = emitters.IsoLine(SLOTS, vector, iso=0.001, line=0.2)
    children, _ = emitted(emitter, archive(Vector(ends), [0, 4]))
    values, parents = np.asarray(children.genotypes.values), np.asarray(children.parents)
    apart = parents[:, 0] != parents[:, 1]
    assert 0.45 < apart.mean() < 0.55
    from_first = np.where(parents[:, 0] == 0, 0.3, -0.3)
    along = (values[:, 0] - from_first)[apart]
    np.testing.assert_allclose(along.std(), 0.2 * 0.6, rtol=0.08)
    np.testing.assert_allclose(values[:, 1:].std(), 0.001, rtol=0.06)


def test_genes_stay_within_their_bounds(archive):
    elite = Vector(jnp.asarray([[1.0, -1.0, 0.99]]))
    children, _ = emitted(emitters.IsoLine(SLOTS, vector, iso=1.0), archive(elite, [0]))
    assert np.abs(children.genotypes.values).max() <= 1.0


@pytest.mark.parametrize("crossover", [0.0, 0.5])
def test_so_many_children_have_two_parents_as_was_asked_for(archive, crossover):
    networks = jax.vmap(network)(jax.random.split(jax.random.key(2), 4))
    rates = neat.Rates(0.6, 1.0, 0.05, 0.1, 0.02, 0.15, 0.25)
    emitter = emitters.Neat(SLOTS, lambda *, key: network(key), rates, 3, crossover)
    children, counters = emitted(emitter, archive(networks, [0, 1, 2, 4]))
    parents, operator = np.asarray(children.parents), np.asarray(children.operator)
    two = parents[:, 1] != search.NO_PARENT
    # A quarter of the second draws find the first parent again.
    assert abs(two.mean() - 0.75 * crossover) < 0.04
    assert (operator[two] == search.OPERATORS.index("crossover")).all()
    assert (operator[~two] == search.OPERATORS.index("neat")).all()
    assert set(parents[:, 0].tolist()) == {0, 1, 2, 4}
    assert int(counters.innovation) > 6


def test_where_nobody_lives_all_children_are_newcomers(archive):
    nobody = archive(Vector(jnp.zeros((1, GENES))), [0])
    nobody = search.Elites(**{**vars(nobody), "occupied": jnp.zeros(5, bool)})
    children, _ = emitted(emitters.IsoLine(64, lambda *, key: vector(key), 0.1, 0.2), nobody)
    assert (np.asarray(children.parents) == search.NO_PARENT).all()
    assert (np.asarray(children.operator) == search.OPERATORS.index("random")).all()
    assert len(np.unique(children.genotypes.values, axis=0)) == 64


def test_each_emitter_is_told_of_its_own_children_alone(archive):
    class Listener:
        slots = 2

        def init(self, *, key):
            return None

        def emit(self, state, archive, counters, *, keys):
            raise AssertionError("nobody asked for children")

        def tell(self, state, outcome):
            return outcome.fitness

    nobody = jnp.zeros(4, jnp.int32)
    outcome = search.Outcome(
        genotypes=Vector(jnp.zeros((4, GENES))),
        fitness=jnp.arange(4.0),
        measures=jnp.zeros((4, 1)),
        sound=nobody == 0,
        cell=nobody,
        entered=nobody == 0,
        fresh=nobody == 0,
        improvement=jnp.zeros(4),
    )
    told = search.emitters.tell((Listener(), Listener()), (None, None), outcome)
    assert [x.tolist() for x in told] == [[0.0, 1.0], [2.0, 3.0]]
