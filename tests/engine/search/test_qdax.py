"""QDax: repertoires there and back, its loop with our scores, its emitters in our loop."""

import importlib
import importlib.util
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import genomes, neat, search
from microcosmos.search import qdax

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(importlib.util.find_spec("qdax") is None, reason="QDax: make peers"),
    pytest.mark.filterwarnings("ignore"),
]

AXES = (
    search.Axis(measure=1, low=1e-2, high=1e2, bins=3, logarithmic=True),
    search.Axis(measure=0, low=-1.0, high=1.0, bins=4, logarithmic=False),
    search.Axis(measure=2, low=0.0, high=2.0, bins=2, logarithmic=False),
)
GRIDS = [search.Grid(AXES[:axes]) for axes in (1, 2, 3)]
AROUND = search.voronoi(AXES[:2], np.random.default_rng(0).random((12, 2)).astype(np.float32))


@pytest.fixture(autouse=True)
def lenient():
    """QDax broadcasts silently."""
    with jax.numpy_rank_promotion("allow"):
        yield


def filled(cells, count=40):
    random = np.random.default_rng(3)
    measures = jnp.asarray(random.uniform(0.02, 1.0, (count, 3)), jnp.float32)
    fitness = jnp.asarray(random.normal(size=count), jnp.float32)
    genotypes = genomes.Vector(jnp.asarray(random.uniform(-1, 1, (count, 5)), jnp.float32))
    rows = search.candidates(7, genotypes, fitness, measures, jnp.ones(count, bool))
    nobody = search.no_elites(cells.count, 3, genomes.Vector(jnp.zeros(5)))
    return search.insert(nobody, rows, cells)[0]


def same(a, b):
    pairs = zip(jax.tree.leaves(a), jax.tree.leaves(b), strict=True)
    return all(np.asarray(x).tobytes() == np.asarray(y).tobytes() for x, y in pairs)


@pytest.mark.parametrize("cells", [*GRIDS, AROUND], ids=["1-d", "2-d", "3-d", "cvt"])
def test_a_repertoire_there_and_back_loses_nothing(cells):
    archive = filled(cells)
    repertoire = qdax.to_repertoire(archive, cells)
    assert same(qdax.from_repertoire(repertoire, cells, 3), archive)


@pytest.mark.parametrize("cells", GRIDS, ids=["1-d", "2-d", "3-d"])
def test_our_grids_are_in_the_order_of_theirs(cells):
    repertoires = qdax.require_qdax("core.containers.mapelites_repertoire")
    shape = tuple(axis.bins for axis in cells.axes)
    theirs = repertoires.compute_euclidean_centroids(shape, 0.0, 1.0)
    repertoire = qdax.to_repertoire(filled(cells), cells)
    np.testing.assert_allclose(repertoire.centroids, theirs, atol=1e-6)
    there = np.isfinite(repertoire.fitnesses[:, 0])
    index = repertoires.get_cells_indices(repertoire.descriptors, repertoire.centroids)
    assert np.array_equal(np.asarray(index)[there], np.flatnonzero(there))


def test_measures_of_their_own_elites_are_made_from_descriptors():
    repertoire = qdax.to_repertoire(filled(AROUND), AROUND).replace(extra_scores={})
    back = qdax.from_repertoire(repertoire, AROUND, 3)
    there = np.asarray(back.occupied)
    expected = filled(AROUND).measures[there]
    np.testing.assert_allclose(back.measures[there][:, :2], expected[:, :2], rtol=1e-5)
    assert np.isnan(back.measures[there][:, 2]).all()


def evaluated(genotypes):
    """A stand-in for simulation: some of it diverges."""
    x = genotypes.values
    measures = jnp.stack([x[:, 0], 10 ** x[:, 1], 1 + x[:, 2]], 1)
    status = jnp.where(x[:, 3] > 0.8, 1, 0)
    measures = jnp.where(status[:, None] == 1, jnp.nan, measures)
    fitness = jnp.where(status == 1, jnp.nan, -jnp.sum(x * x, 1))
    return search.Evaluation(fitness, measures, status)


def test_their_map_elites_runs_on_our_scores_and_what_is_infeasible_never_enters():
    names = ("core.map_elites", "core.emitters.standard_emitters")
    loop, emitters = map(qdax.require_qdax, names)
    score = qdax.scoring_function(evaluated, AROUND)

    def mutate(x, key):
        return x + 0.3 * jax.random.normal(key, x.shape)

    mix = emitters.MixingEmitter(mutate, None, 0.0, 32)
    run = loop.MAPElites(score, mix, lambda repertoire: {})
    first = jax.random.uniform(jax.random.PRNGKey(0), (32, 5), minval=-1.0, maxval=1.0)
    repertoire, state, _ = run.init(first, AROUND.centroids, jax.random.PRNGKey(1))
    before = repertoire.fitnesses
    for number in range(5):
        repertoire, state, _ = run.update(repertoire, state, jax.random.PRNGKey(number))
    there = np.isfinite(repertoire.fitnesses[:, 0])
    assert np.all(repertoire.fitnesses >= before)
    assert there.sum() > 6
    assert np.isfinite(repertoire.descriptors).all()
    assert np.all(np.asarray(repertoire.genotypes)[there][:, 3] <= 0.8)


def looped(generations, emitter, archive, state, begin=0):
    counters = neat.first_counters(1, 1)
    for number in map(jnp.asarray, range(begin, begin + generations)):
        given = ((emitter,), (state,), archive, counters, number)
        children, (state,), _ = search.emitters.emit(*given, key=jax.random.key(5))
        found = evaluated(children.genotypes)
        columns = (found.fitness, found.measures, found.status == 0)
        rows = search.candidates(number, children.genotypes, *columns)
        archive, inserted = search.insert(archive, rows, AROUND)
        state = emitter.tell(state, search.emitters.outcome(rows, inserted))
    return archive, state


def newcomer(*, key):
    return genomes.Vector(jax.random.uniform(key, (5,), minval=-1.0, maxval=1.0))


def test_cma_me_climbs_in_our_loop_and_goes_on_from_kept_arrays():
    emitter = qdax.cma_me(16, newcomer, AROUND, step=0.3, emitters=2)
    nobody = search.no_elites(12, 3, genomes.Vector(jnp.zeros(5)))
    start = emitter.init(key=jax.random.key(0))
    assert all(isinstance(x, jax.Array) and x.dtype != object for x in jax.tree.leaves(start))
    early, kept = looped(3, emitter, nobody, start)
    whole, state = looped(6, emitter, early, kept, begin=3)
    again = jax.tree.map(lambda x: jnp.asarray(np.array(x)), kept)
    assert same(looped(6, emitter, early, again, begin=3), (whole, state))
    assert jax.tree.structure(state) == jax.tree.structure(start)
    strategies = state.emitter.emitter_states.cmaes_state
    assert all(np.isfinite(x).all() for x in jax.tree.leaves(strategies))
    assert int(whole.occupied.sum()) >= int(early.occupied.sum())
    assert np.all(whole.fitness[early.occupied] >= early.fitness[early.occupied])


def network_scores(networks, key=None):
    """A stand-in for simulation: more hidden nodes are fitter; weights say where."""
    hidden = jnp.sum(networks.node_used, 1) - 3.0
    used = networks.connection_used
    mean = jnp.sum(jnp.where(used, networks.weight, 0.0), 1) / jnp.sum(used, 1)
    place = jax.nn.sigmoid(jnp.stack([mean, networks.bias[:, 2]], 1))
    return hidden, place, {}


def test_our_neat_grows_networks_in_their_map_elites_and_numbers_them_alike():
    loop, multi = map(qdax.require_qdax, ("core.map_elites", "core.emitters.multi_emitter"))
    rates = neat.Rates(0.8, 0.5, 0.1, 0.1, toggle=0.1, add_node=0.5, add_connection=0.3)

    def minimal(*, key):
        return neat.minimal(key, 2, 1, 16, 32)

    def emitter(crossover):
        return qdax.NeatEmitter(search.emitters.Neat(16, minimal, rates, 2, crossover))

    both = multi.MultiEmitter((emitter(0.0), emitter(0.5)))
    run = loop.MAPElites(network_scores, both, lambda repertoire: {})
    first = jax.vmap(lambda key: minimal(key=key))(jax.random.split(jax.random.key(0), 32))
    repertoire, state, _ = run.init(first, AROUND.centroids, jax.random.PRNGKey(1))
    assert [int(s.innovation) for s in state.emitter_states] == [2, 2]
    update = jax.jit(run.update)
    for number in range(12):
        repertoire, state, _ = update(repertoire, state, jax.random.PRNGKey(number))
    there = np.isfinite(repertoire.fitnesses[:, 0])
    assert repertoire.fitnesses[there].max() >= 3
    kept = jax.tree.map(lambda x: np.asarray(x)[there], repertoire.genotypes)
    used = kept.connection_used
    assert kept.innovation[used].max() < int(state.emitter_states[0].innovation)
    rows = [r[u] for r, u in zip(kept.innovation, used, strict=True)]
    assert all((np.diff(numbers) > 0).all() for numbers in rows)


def test_without_qdax_the_error_names_the_command(monkeypatch):
    def missing(name):
        raise ImportError(name)

    monkeypatch.setattr(importlib, "import_module", missing)
    with pytest.raises(ValueError, match=r'pip install "microcosmos\[qdax\]"'):
        qdax.require_qdax("core.map_elites")


@pytest.mark.parametrize("name", ["arm", "rastrigin"])
def test_our_map_elites_reaches_the_score_of_theirs(name, monkeypatch):
    folder = Path(__file__).parents[3] / "engine" / "benchmarks"
    monkeypatch.syspath_prepend(str(folder))
    functions = importlib.import_module("functions")
    monkeypatch.setattr(functions, "GENES", 6)
    functions.cells.cache_clear()
    cells = functions.cells(128)
    monkeypatch.setattr(functions, "cells", lambda: cells)
    ours = [functions.ours(name, seed, 60, 64) for seed in range(3)]
    theirs = [functions.theirs(name, seed, 60, 64) for seed in range(3)]
    spread = max(np.ptp(ours), np.ptp(theirs), 0.01 * np.mean(theirs))
    assert abs(np.median(ours) - np.median(theirs)) <= 2 * spread


@pytest.mark.parametrize("kind", ["continuous", "levels"])
def test_fronts_that_are_not_full_hold_what_theirs_do(kind):
    """Theirs also keep copies of a pair of objectives, ours the first of them."""
    repertoires = importlib.import_module("qdax.core.containers.mome_repertoire")
    axes = tuple(search.Axis(i, 0.0, 1.0, 3) for i in range(2))
    fronts = search.Fronts(search.Grid(axes), search.Axis(2, 0.0, 1.0, 1), 64, least=False)
    random = np.random.default_rng(6)
    for generation in range(1, 4):
        drawn = random.random((60, 4))
        if kind == "levels":
            drawn[:, :2] = np.round(4 * drawn[:, :2]) / 4
        both, descriptors = jnp.split(jnp.asarray(drawn, jnp.float32), 2, axis=1)
        measures = jnp.concatenate([descriptors, both[:, 1:]], 1)
        genotypes = genomes.Vector(jnp.asarray(random.random((60, 4)), jnp.float32))
        able = jnp.ones(60, bool)
        rows = search.candidates(generation, genotypes, both[:, 0], measures, able)
        given = genotypes.values, measures[:, :2], both
        if generation == 1:
            archive = search.no_elites(fronts.count, 3, genomes.Vector(jnp.zeros(4)))
            centroids = jnp.asarray(fronts.cells.centres)
            theirs = repertoires.MOMERepertoire.init(given[0], both, given[1], centroids, 64)
        else:
            theirs = theirs.add(*given)
        archive, _ = search.insert(archive, rows, fronts)
        there = np.asarray(archive.occupied)
        cell = np.asarray(fronts.cells.of(archive.measures))[there]
        ours = np.stack([archive.fitness, archive.measures[:, 2]], 1)[there]
        for number, front in enumerate(np.asarray(theirs.fitnesses)):
            front = front[np.isfinite(front).all(1)]
            assert len(front) < 64
            found = sorted(map(tuple, ours[cell == number].tolist()))
            assert found == sorted(set(map(tuple, front.tolist())))
