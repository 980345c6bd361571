"""Several emitters vary networks in one run: numbers of new genes, and species."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import pytest

from microcosmos import genomes, neat, search
from microcosmos.search import emitters

pytestmark = pytest.mark.long

INPUTS, OUTPUTS, NODES, CONNECTIONS, SLOTS = 3, 2, 14, 40, 32
GENERATIONS = 8
PAPER = neat.PRESETS["paper"]
RATES = replace(PAPER.rates, add_node=0.3, add_connection=0.4, weight_step=0.5)
SETTINGS = replace(
    PAPER,
    rates=RATES,
    population=SLOTS,
    threshold=0.8,
    coefficients=neat.Coefficients(1.0, 1.0, 0.4),
)


def newcomer(*, key):
    return neat.minimal(key, INPUTS, OUTPUTS, NODES, CONNECTIONS)


EMITTERS = (
    emitters.Neat(SLOTS, newcomer, RATES, INPUTS, crossover=0.4),
    emitters.Random(SLOTS, newcomer),
    emitters.PopulationNeat(SLOTS, newcomer, SETTINGS, INPUTS, OUTPUTS),
)


@pytest.fixture(scope="module")
def history():
    """The children, the counters before and after, and the population, of each generation."""
    cells = search.Grid(
        (search.Axis(measure=0, low=0.0, high=1.0, bins=12, logarithmic=False),)
    )

    @jax.jit
    def advance(states, archive, counters, number):
        given = (EMITTERS, states, archive, counters, number)
        children, states, counters = emitters.emit(*given, key=jax.random.key(5))
        draw = jax.random.uniform(jax.random.fold_in(jax.random.key(6), number), (2, 3 * SLOTS))
        sound = jnp.ones(3 * SLOTS, bool)
        rows = search.candidates(number, children.genotypes, draw[0], draw[1][:, None], sound)
        archive, inserted = search.insert(archive, rows, cells)
        states = emitters.tell(EMITTERS, states, emitters.outcome(rows, inserted))
        return children, states, archive, counters

    keys = jax.random.split(jax.random.key(0), len(EMITTERS))
    pairs = zip(EMITTERS, keys, strict=True)
    states = tuple(emitter.init(key=key) for emitter, key in pairs)
    archive = search.no_elites(cells.count, 1, newcomer(key=keys[0]))
    counters, found = neat.first_counters(INPUTS, OUTPUTS), []
    for number in range(GENERATIONS):
        before = counters
        children, states, archive, counters = advance(
            states, archive, before, jnp.asarray(number)
        )
        found.append((children, before, counters, states[2]))
    return jax.device_get(found)


def links(network):
    """Return the number of each connection, by the numbers of its ends."""
    used = network.connection_used
    ids = network.node_id[network.source[used]], network.node_id[network.target[used]]
    return dict(zip(zip(*ids, strict=True), network.innovation[used], strict=True))


def new_genes(generation, slots):
    """Return (ends, number) of the new connections and (split number, number) of new nodes."""
    children, before, *_ = generation
    added, split = set(), set()
    for slot in slots:
        own = links(genomes.take(children.genotypes, slot))
        new = {ends: n for ends, n in own.items() if n >= before.innovation}
        added |= set(new.items())
        for source, node in new:
            if node >= before.node:
                (target,) = (b for a, b in new if a == node)
                split.add((own[source, target], node))
    return added, split


def test_equal_mutations_of_different_emitters_get_equal_numbers(history):
    shared = [0, 0]
    for generation in history:
        ours, theirs = (
            new_genes(generation, range(first, first + SLOTS)) for first in (0, 2 * SLOTS)
        )
        for kind, (one, other) in enumerate(zip(ours, theirs, strict=True)):
            whole = one | other
            mutations, numbers = zip(*whole, strict=True) if whole else ((), ())
            assert len(set(mutations)) == len(set(numbers)) == len(whole)
            shared[kind] += len(one & other)
    assert min(shared) > 3


def test_each_new_number_is_given_to_a_gene_and_none_is_skipped(history):
    for generation in history:
        _, before, after, _ = generation
        added, split = new_genes(generation, range(3 * SLOTS))
        innovations = {number for _, number in added}
        assert innovations == set(range(before.innovation, after.innovation))
        assert {number for _, number in split} == set(range(before.node, after.node))
    assert history[0][1].innovation == history[0][2].innovation
    assert history[-1][2].node > INPUTS + OUTPUTS + 10
