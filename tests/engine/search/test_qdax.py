"""QDax: repertoires there and back, its loop with our scores, its emitters in our loop."""

import importlib
import importlib.util
from dataclasses import replace
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from small_spec import SMALL_RUN

import microcosmos
from microcosmos import genomes, neat, search
from microcosmos.build.encodings import build_encoding
from microcosmos.invalid import InvalidField
from microcosmos.search import qdax
from microcosmos.units import MAX_LIMITED

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


def test_a_repertoire_over_other_cells_is_refused():
    two, four = (
        search.Grid(tuple(search.Axis(i, 0.0, 1.0, bins) for i in range(2))) for bins in (2, 4)
    )
    whole = qdax.to_repertoire(filled(four), four)
    with pytest.raises(InvalidField, match=r"must have one fitness in each of 4 cells"):
        qdax.from_repertoire(whole, two, 3)
    shifted = whole.replace(centroids=whole.centroids + 0.01)
    with pytest.raises(InvalidField, match="must have the centroids of `cells`"):
        qdax.from_repertoire(shifted, four, 3)
    fronts = whole.replace(fitnesses=jnp.zeros((16, 5, 2)))
    with pytest.raises(
        InvalidField, match=r"one fitness in each of 16 cells; got \(16, 5, 2\)"
    ):
        qdax.from_repertoire(fronts, four, 3)


FULL = np.linspace(0.125, 0.875, 4)
"""Middles of four bins."""


@pytest.mark.parametrize(
    ("field", "changed", "got"),
    [
        ("descriptors", lambda one: one.descriptors[:, :1], r"shape \(16, 2\); got \(16, 1\)"),
        ("descriptors", lambda one: one.descriptors[:4], r"got \(4, 2\)"),
        (
            "descriptors",
            lambda one: one.descriptors.at[3].set(jnp.nan),
            "finite.* got 1 others",
        ),
        ("descriptors", lambda one: one.descriptors[::-1], "own cell; got 16 others"),
        ("genotypes", lambda one: one.genotypes[:4], "must have 16 rows"),
        ("genotypes", lambda one: one.genotypes.at[2, 1].set(jnp.nan), "-1 to 1; got 1 others"),
        ("genotypes", lambda one: one.genotypes.at[2:5, 1].set(1.5), "-1 to 1; got 3 others"),
        ("fitnesses", lambda one: one.fitnesses.at[1].set(jnp.inf), "finite.* got 1 others"),
        ("measures", lambda one: one.extra_scores["measures"][:, :1], r"got \(16, 1\)"),
        ("measures", lambda one: one.extra_scores["measures"][::-1], "own cell; got 16 others"),
        ("slot", lambda one: one.extra_scores["slot"][:4], r"got \(4,\)"),
    ],
)
def test_elites_that_no_archive_of_ours_has_are_refused(field, changed, got):
    cells = search.Grid(tuple(search.Axis(i, 0.0, 1.0, 4) for i in range(2)))
    middles = jnp.asarray(np.stack(np.meshgrid(FULL, FULL, indexing="ij"), -1).reshape(16, 2))
    rows = search.candidates(
        1,
        genomes.Vector(jnp.zeros((16, 3), jnp.float32)),
        jnp.arange(16.0),
        middles.astype(jnp.float32),
        jnp.ones(16, bool),
    )
    nobody = search.no_elites(16, 2, genomes.Vector(jnp.zeros(3)))
    archive = search.insert(nobody, rows, cells)[0]
    whole = qdax.to_repertoire(replace(archive, genotypes=rows.genotypes), cells)
    assert np.isfinite(whole.fitnesses).all()
    with pytest.raises(InvalidField, match="`measures` must be a whole number, at least 2"):
        qdax.from_repertoire(whole, cells, 1)
    if field in whole.extra_scores:
        wrong = whole.replace(extra_scores={**whole.extra_scores, field: changed(whole)})
    else:
        wrong = whole.replace(**{field: changed(whole)})
    with pytest.raises(InvalidField, match=f"{field}` .*{got}"):
        qdax.from_repertoire(wrong, cells, 2)


@pytest.mark.parametrize("kind", ["fronts", "dominated-novelty", "learned"])
def test_an_archive_without_an_elite_in_each_cell_is_no_repertoire(kind, tmp_path):
    archive = {"container": {"kind": kind}}
    microcosmos.evolve(microcosmos.parse(SMALL_RUN | {"archive": archive}), tmp_path / "a.h5")
    with pytest.raises(InvalidField, match=r"`archive\.container` must keep one elite"):
        microcosmos.to_repertoire(tmp_path / "a.h5")


@pytest.mark.parametrize("feasible", [False, True])
def test_scores_are_of_feasible_creatures_alone_where_the_search_asks_for_them(feasible):
    emitters = [{"operator": "iso+line"}]
    wild = {"control": {"encoding": "direct", "period": 20, "max_speed": None, "lag": 0.0}}
    search_of = {"batch": 4, "emitters": emitters, "feasible": feasible}
    spec = microcosmos.parse(SMALL_RUN | wild | {"search": search_of})
    genes = build_encoding(spec.scene, (8, 8)).newcomer(key=jax.random.key(0)).values.shape[0]
    ends = np.sign(np.random.default_rng(0).normal(size=(4, genes))).astype(np.float32)
    rows = np.concatenate([ends, 0.01 * ends])
    fitness, _, extra = jax.jit(microcosmos.scoring_function(spec))(rows)
    limited = np.asarray(extra["measures"][:, search.MEASURES.index("limited")])
    assert (limited[:4] > MAX_LIMITED).all()
    np.testing.assert_array_equal(np.isfinite(fitness), [not feasible] * 4 + [True] * 4)


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
    theirs = [functions.qdax(name, seed, 60, 64) for seed in range(3)]
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
