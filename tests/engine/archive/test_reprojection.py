"""Re-projection against an insertion one by one, the engine's bins, and in any order."""

from dataclasses import asdict

import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import search
from microcosmos.archive.axes import BINS, Axis, axis, of_spec
from microcosmos.archive.population import Creatures, creatures
from microcosmos.archive.reprojection import over, reproject
from microcosmos.measures import MEASURES
from microcosmos.spec import Archive, Descriptor, QualityDiversity

AXES = (Axis("mach", 1e-3, 1.0, 5, "log10"), Axis("symmetry", -1.0, 1.0, 4))
MACH = Descriptor(name="mach", low=0.01, bins=7)
COUNT = 400


def given(seed=0, count=COUNT):
    """Columns of random creatures; many are equally fit, some have no value."""
    rng = np.random.default_rng(seed)
    mach = 10 ** rng.uniform(-4, 1, count)
    mach[rng.random(count) < 0.05] = np.nan
    return {
        "names": [rng.bytes(32).hex() for _ in range(count)],
        "fitness": np.where(rng.random(count) < 0.05, -np.inf, rng.integers(-3, 5, count)),
        "generation": rng.integers(0, 30, count),
        "mach": mach,
        "symmetry": rng.uniform(-1.2, 1.2, count),
    }


def made(columns, order=slice(None)):
    columns = {name: np.array(column)[order] for name, column in columns.items()}
    measures = {name: columns.pop(name) for name in ("mach", "symmetry")}
    return creatures(
        list(columns["names"]), columns["fitness"], columns["generation"], measures
    )


def one_by_one(found: Creatures, until=np.inf):
    """Insert in the order of rows: cell to (−fitness, name)."""
    elites = {}
    bins = np.stack([one.bin(found.measures[one.name]) for one in AXES], 1)
    for row in range(len(found)):
        values = [found.fitness[row], *(found.measures[one.name][row] for one in AXES)]
        if not np.all(np.isfinite(values)) or found.generation[row] > until:
            continue
        cell = int(bins[row] @ (AXES[1].bins, 1))
        mine = (-found.fitness[row], found.names[row])
        elites[cell] = min(elites.get(cell, mine), mine)
    return {cell: name for cell, (_, name) in elites.items()}


def test_the_best_of_each_cell_is_its_elite_and_the_smaller_name_decides():
    found = made(given())
    projected = reproject(found, AXES)
    names = found.names[projected.elites]
    assert dict(zip(projected.filled.tolist(), names, strict=True)) == one_by_one(found)
    assert projected.coverage == len(one_by_one(found)) / 20
    assert projected.qd_score == sum(found.fitness[projected.elites].astype(float))
    assert projected.best == found.fitness[np.isfinite(found.measures["mach"])].max()


def test_entries_give_the_archive_of_each_generation():
    found = made(given())
    projected = reproject(found, AXES)
    for generation in range(31):
        then = {}
        for row, cell in zip(projected.entries, projected.cells.tolist(), strict=True):
            if found.generation[row] <= generation:
                then[cell] = found.names[row]
        assert then == one_by_one(found, generation)


@pytest.mark.parametrize("seed", range(5))
def test_the_order_of_creatures_has_no_effect(seed):
    columns = given(seed)
    order = np.random.default_rng(seed).permutation(COUNT)
    asked = {"names": ["pc1", "mach"], "components_of": ["mach", "symmetry"]}
    one, other = (over(made(columns, o), **asked)[0] for o in (slice(None), order))
    for name in ("entries", "cells", "elites", "filled"):
        assert np.array_equal(getattr(one, name), getattr(other, name))
    assert one.axes == other.axes
    assert (one.qd_score, one.coverage) == (other.qd_score, other.coverage)


def test_a_creature_that_entered_twice_counts_once_from_its_first_entry():
    columns = given()
    twice = {name: np.concatenate([column, column]) for name, column in columns.items()}
    twice["generation"][COUNT:] += 50
    assert len(made(twice)) == COUNT
    assert made(twice).generation.max() < 50
    assert np.array_equal(made(twice).names, made(columns).names)


@pytest.mark.parametrize("measure", ["mach", "symmetry", "cost_of_transport", "rings"])
def test_bins_are_those_of_an_archive(measure):
    usual = MEASURES[measure]
    mine = axis(measure, usual, np.empty(0))
    ends = (usual.low, usual.high, 24, usual.scale == "log10")
    theirs = search.Axis(0, *ends)
    below = np.nextafter(theirs.edges, np.float32(-np.inf))
    below = below[np.abs(below) > 1e-37]  # XLA takes subnormal numbers as 0.
    near = np.concatenate([theirs.edges, below])
    beyond = np.array([usual.low, usual.high, 3 * usual.high, -7.0], np.float32)
    values = np.concatenate([near, beyond])
    assert mine.bin(values).tolist() == theirs.bin(jnp.asarray(values)).tolist()


def test_an_axis_has_the_ends_of_the_archive_or_of_the_measure():
    found = made(given())
    spec = QualityDiversity(archive=Archive(descriptors=(MACH,))).model_dump(mode="json")
    projected, learned = over(found, ["mach", "symmetry"], of_spec(spec))
    assert learned == []
    assert [asdict(one) for one in projected.axes] == [
        {"name": "mach", "low": 0.01, "high": 1.0, "bins": 7, "scale": "log10"},
        {"name": "symmetry", "low": -1.0, "high": 1.0, "bins": 24, "scale": "linear"},
    ]
    assert [a.bins for a in over(found, ["mach", "symmetry"], of_spec(spec), [9])[0].axes] == [
        9,
        9,
    ]
    assert [a.bins for a in over(found, ["mach", "symmetry"], {}, [9, 3])[0].axes] == [9, 3]
    assert of_spec(spec | {"archive": spec["archive"] | {"centroids": 9}})["mach"].bins == BINS
    fitness = over(found, ["fitness"])[0].axes[0]
    assert (fitness.low, fitness.high) == (-3.0, 4.0)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"names": ["mach", "beauty"]}, "fitness, pc1 to pc9 or measures .*got beauty"),
        ({"names": ["mach", "mach"]}, "names that differ"),
        ({"names": []}, "got none"),
        ({"names": ["mach"], "bins": [0]}, "from 1 to 1,024"),
        ({"names": ["mach"], "bins": [3, 4]}, "one for each axis; got 3, 4"),
        ({"names": ["mach", "symmetry", "fitness"], "bins": [1024]}, "at most 1,048,576"),
        ({"names": ["pc1"], "components_of": ["beauty"]}, "components_of.*got beauty"),
        ({"names": ["pc3"]}, "at least 3 measures that vary .*got 1 and 400"),
    ],
)
def test_wrong_names_and_bins_are_refused(asked, message):
    with pytest.raises(ValueError, match=message):
        over(made(given()), **asked)
