"""Phylogenies: times over several runs, cycles, and their files read back."""

import csv
import io

import numpy as np
import pytest

from microcosmos.archive import columns
from microcosmos.archive.phylogeny import NONE, Birth, alife_csv, births_of, phylogeny
from microcosmos.archive.phylogeny import newick as written


def sha(number):
    return f"{number:064x}"


def birth(number, *parents, run="a", generation=None, lost=NONE, fitness=1.0):
    then = number if generation is None else generation
    names = [sha(parent) for parent in parents]
    ended = {} if lost == NONE else {run: lost}
    return Birth(sha(number), names, run, then, ended, "neat", fitness)


def random_births(count, seed=0):
    """Each has up to two parents among the earlier ones, of any earlier generation."""
    draw = np.random.default_rng(seed)
    births = []
    for i in range(1, count + 1):
        parents = draw.integers(1, i, 2).tolist() if i > 4 else []
        births.append(birth(i, *parents, generation=i, lost=i + 3 if i % 3 else NONE))
    return [births[i] for i in draw.permutation(count)]


def named(found):
    return {
        (found.creature[child], found.creature[parent])
        for child, parent in found.links.tolist()
    }


def test_every_parent_precedes_its_children_and_no_link_is_lost():
    births = random_births(500)
    found = phylogeny(births, ["a"])
    child, parent = found.links.T
    assert (parent < child).all()
    assert (found.time[parent] < found.time[child]).all()
    assert found.time.tolist() == sorted(found.time)
    assert named(found) == {(one.creature, name) for one in births for name in one.parents}


def test_a_fork_begins_when_the_creatures_of_its_start_exist():
    old = [birth(1, generation=5), birth(2, 1, generation=40)]
    fork = [birth(n, 2 - n % 2, run="b", generation=1) for n in (3, 4)]
    later = [birth(5, 3, run="b", generation=7), birth(6, 5, run="c", generation=2)]
    found = phylogeny([*later, *fork, *old], ["a", "b", "c"])
    times = dict(zip(found.creature, found.time.tolist(), strict=True))
    assert [times[sha(n)] for n in range(1, 7)] == [5, 40, 41, 41, 47, 49]
    assert [found.runs[run] for run in found.run] == ["a", "a", "b", "b", "b", "c"]


def test_a_fork_begins_after_an_initial_creature_that_has_no_children_in_it():
    old = [birth(1, generation=5), birth(2, generation=40)]
    fork = [birth(3, 1, run="b", generation=1)]
    found = phylogeny([*old, *fork], ["a", "b"], [("b", sha(1)), ("b", sha(2)), ("c", sha(1))])
    assert found.time.tolist() == [5, 40, 41]


def test_claims_that_contradict_each_other_are_no_links():
    """Provenance stands outside the hash, so that two files can name each other as parents."""
    births = [birth(1, 2), birth(2, 1), birth(3, 3), birth(4, 1), birth(5)]
    found = phylogeny(births, ["a"])
    assert len(found.creature) == 5
    child, parent = found.links.T
    assert (found.time[parent] < found.time[child]).all()


def test_unknown_parents_are_left_out_and_the_first_known_one_comes_first():
    births = [birth(1), birth(2), birth(3, 9, 2, 1, 2)]
    found = phylogeny(births, ["a"])
    assert found.links.tolist() == [[2, 1], [2, 0]]


def test_the_alife_table_is_read_back():
    found = phylogeny(random_births(300), ["a"])
    rows = list(csv.DictReader(io.StringIO(alife_csv(found))))
    assert [int(row["id"]) for row in rows] == list(range(300))
    read = set()
    for row in rows:
        ancestors = row["ancestor_list"].strip("[]")
        for ancestor in ancestors.split(",") if ancestors != "none" else ():
            older = rows[int(ancestor)]
            assert float(older["origin_time"]) < float(row["origin_time"])
            read.add((row["taxon_label"], older["taxon_label"]))
    assert read == named(found)
    ended = [row["destruction_time"] for row in rows]
    assert ended == ["inf" if i % 3 == 0 else str(i + 3) for i in range(1, 301)]


@pytest.mark.parametrize(
    ("ends", "time"),
    [
        ([("a", 2), ("a", None)], NONE),
        ([("a", 2), ("a", 5)], 5),
        ([("a", 3), ("b", None)], NONE),  # A fork keeps what its origin has lost.
        ([("a", None), ("b", 3)], NONE),
        ([("a", 3), ("b", 7)], 8),  # The fork begins with the birth, at 1.
        ([("a", 9), ("b", 7)], 9),
    ],
)
def test_a_creature_is_lost_with_its_last_cell_in_any_run(ends, time):
    entries = [(sha(1), run, 1, end, "neat", 1.0) for run, end in ends]
    for order in (entries, [*entries[:1], *entries[:0:-1]]):
        found = phylogeny(births_of(order, {}), ["a", "b"], [("b", sha(1))])
        assert (found.time.tolist(), found.destruction.tolist()) == ([1], [time])


def test_a_creature_that_entered_no_archive_was_never_alive():
    absent = Birth(sha(1), (), None, NONE, {}, None, None)
    found = phylogeny([absent, birth(2, 1, generation=1_234_567)], ["a"])
    first, second = csv.DictReader(io.StringIO(alife_csv(found)))
    assert first["destruction_time"] == first["origin_time"]
    assert (second["origin_time"], second["destruction_time"]) == ("1234567", "inf")


def test_a_line_of_descent_of_any_length_is_written():
    line = phylogeny([birth(i, *([i - 1] if i > 1 else [])) for i in range(1, 3001)], ["a"])
    assert written(line).count("(") == 2999


@pytest.mark.parametrize("count", [0, 1, 40])
def test_columns_say_what_the_phylogeny_says(count):
    found = phylogeny(random_births(count), ["a"])
    _, arrays = columns.load(columns.dump({}, found.columns))
    assert [bytes(row).hex() for row in arrays["creature"]] == found.creature
    for name in ("links", "time", "run", "lost", "operator", "generation", "fitness"):
        np.testing.assert_array_equal(arrays[name], getattr(found, name))
