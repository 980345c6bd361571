"""Phylogenies of runs and creatures over HTTP, across forks."""

import csv
import io
from uuid import UUID

import newick
import pytest
import reports
from answers import detail

from microcosmos.archive import columns, creature
from microcosmos.spec import parse
from server.attempts.claim import claim
from server.phylogenies import births
from server.runs.submission import submit
from server.tables import Elite, Run


def name(number):
    return creature.name(reports.identity(number))


def generation_of(number, elites):
    """A report of new elites: (number, cell, numbers of parents)."""
    found = reports.report(number, {cell: float(one) for one, cell, _ in elites})
    for elite, (one, _, parents) in zip(found.elites, elites, strict=True):
        vars(elite).update(reports.creature_of(one))
        elite.provenance = elite.provenance | {"parents": [name(p) for p in parents]}
    return found


@pytest.fixture
def write(services, run_id):
    """Writes generations of the run, or of another."""
    attempts = {}

    def write(*generations, run=run_id):
        if run not in attempts:
            attempts[run] = claim(services, run, "worker")
        for number, elites in enumerate(generations, 1):
            attempts[run].record(generation_of(number, elites), 1.0)

    return write


@pytest.fixture
def start_from(services, spec):
    """Starts a run from creatures by number."""

    def start(*numbers):
        search = {**spec["search"], "initial": [name(one) for one in numbers]}
        return submit(services, parse({**spec, "search": search}))[0].id

    return start


def read(api, path):
    answer = api.get(f"{path}/phylogeny")
    assert answer.headers["content-type"] == columns.MEDIA_TYPE
    return columns.load(answer.content)


def family(arrays):
    names = [bytes(row).hex() for row in arrays["creature"]]
    parents = {one: [] for one in names}
    for child, parent in arrays["links"].tolist():
        parents[names[child]].append(names[parent])
    return parents


@pytest.mark.postgresql
def test_the_tree_of_a_run_has_all_that_ever_entered(api, run_id, write):
    write([(1, 5, ()), (2, 6, ())], [(3, 5, (1,))], [(4, 7, (3, 2)), (5, 5, (4,))])
    header, arrays = read(api, f"runs/{run_id}")
    one, two, three, four, five = map(name, range(1, 6))
    assert family(arrays) == {
        one: [],
        two: [],
        three: [one],
        four: [three, two],
        # Born in the generation of its parent: it comes after it.
        five: [four],
    }
    assert header["runs"] == [str(run_id)]
    assert header["operators"] == ["neat"]
    facts = dict(
        zip(
            family(arrays),
            zip(*(arrays[k].tolist() for k in ("generation", "lost", "fitness")), strict=True),
            strict=True,
        )
    )
    assert facts == {
        one: (1, 2, 1.0),
        two: (1, -1, 2.0),
        three: (2, 3, 3.0),
        four: (3, -1, 4.0),
        five: (3, -1, 5.0),
    }


def test_a_creature_that_moved_to_another_cell_is_not_lost(api, run_id, write):
    write([(1, 5, ()), (1, 6, ())], [(2, 5, ())])
    _, arrays = read(api, f"runs/{run_id}")
    assert arrays["lost"].tolist() == [-1, -1]


@pytest.mark.postgresql
def test_the_tree_of_a_fork_leads_to_the_run_before(api, run_id, write, start_from):
    write([(1, 5, ())], [(2, 5, (1,)), (8, 6, ())])
    fork = start_from(2)
    write([(3, 5, (2,)), (2, 9, (1,))], run=fork)
    header, arrays = read(api, f"runs/{fork}")
    one, two, three = map(name, (1, 2, 3))
    assert family(arrays) == {one: [], two: [one], three: [two]}
    assert header["runs"] == [str(run_id), str(fork)]
    # The fork has the same creature, which was born before.
    assert arrays["run"].tolist() == [0, 0, 1]
    assert arrays["time"].tolist() == [1, 2, 3]


@pytest.mark.postgresql
def test_the_tree_of_a_creature_has_its_ancestors_and_descendants_of_any_run(
    api, run_id, write, start_from
):
    write([(1, 5, ()), (9, 4, ())], [(2, 5, (1,)), (8, 6, (1,))])
    fork = start_from(2)
    write([(3, 5, (2,))], run=fork)
    _, arrays = read(api, f"creatures/{name(2)}")
    assert list(family(arrays)) == [name(1), name(2), name(3)]
    _, arrays = read(api, f"creatures/{name(1)}")
    assert set(family(arrays)) == {name(one) for one in (1, 2, 3, 8)}


def test_the_files_of_a_tree_are_read_back(api, run_id, write):
    write([(1, 5, ())], [(2, 5, (1,)), (3, 6, (1,))])
    parents = family(read(api, f"runs/{run_id}")[1])
    for path in (f"runs/{run_id}", f"creatures/{name(1)}"):
        table = api.get(f"{path}/phylogeny.csv")
        assert table.headers["content-type"].startswith("text/csv")
        assert "phylogeny-" in table.headers["content-disposition"]
        rows = list(csv.DictReader(io.StringIO(table.text)))
        for row in rows:
            ancestors = [
                int(one) for one in row["ancestor_list"][1:-1].split(",") if one != "none"
            ]
            assert [rows[one]["taxon_label"] for one in ancestors] == parents[
                row["taxon_label"]
            ]
        assert {row["taxon_label"] for row in rows} == set(parents)
        nodes = newick.read(api.get(f"{path}/phylogeny.nwk").text)
        assert {one.label: [one.parent] if one.parent else [] for one in nodes} == parents


def test_a_known_tree_is_not_sent_again_until_it_grows(api, run_id, write, start_from, upload):
    write([(1, 5, ())])
    fork = start_from(1)
    for path in (f"runs/{fork}", f"creatures/{name(1)}"):
        tag = api.get(f"{path}/phylogeny").headers["etag"]
        known = {"If-None-Match": tag}
        assert api.get(f"{path}/phylogeny", headers=known).status_code == 304
    write([(2, 5, (1,))], run=fork)
    for path in (f"runs/{fork}", f"creatures/{name(1)}"):
        answer = api.get(f"{path}/phylogeny", headers=known)
        assert answer.status_code == 200
        assert name(2) in family(columns.load(answer.content)[1])


def test_an_imported_creature_is_a_tree_and_a_run_without_elites_an_empty_one(
    api, run_id, upload
):
    alone = upload(reports.identity(7))
    _, arrays = read(api, f"creatures/{alone}")
    assert family(arrays) == {alone: []}
    assert (arrays["run"].tolist(), arrays["generation"].tolist()) == ([-1], [-1])
    header, arrays = read(api, f"runs/{run_id}")
    assert (header["runs"], family(arrays)) == ([], {})


def test_missing_ones_tables_and_large_trees_are_refused(
    api, run_id, sweep_id, write, monkeypatch
):
    write([(1, 5, ()), (2, 6, ())], [(3, 5, (1,))])
    for ending in ("", ".csv", ".nwk"):
        missing = api.get(f"creatures/{'ab' * 32}/phylogeny{ending}")
        assert "No creature has the name" in detail(missing, 404)
        assert api.get(f"runs/{UUID(int=0)}/phylogeny{ending}").status_code == 404
        assert "has no archive" in detail(api.get(f"runs/{sweep_id}/phylogeny{ending}"), 404)
    monkeypatch.setattr(births, "MAX_CREATURES", 1)
    for path in (f"runs/{run_id}", f"creatures/{name(1)}"):
        assert "more than the 1" in detail(api.get(f"{path}/phylogeny"), 422)


def test_a_tree_takes_few_statements_however_large_it_is(services, run_id, write, statements):
    write(*[[(100 * g + cell, cell, ()) for cell in range(g, g + 20)] for g in range(1, 6)])
    with services.sessions.read() as session:
        run = session.get_one(Run, run_id)
        assert session.query(Elite).count() == 100
        assert statements(births.entered, session, run) == 3
