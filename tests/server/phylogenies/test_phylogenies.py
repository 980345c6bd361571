"""Phylogenies of runs and creatures over HTTP, across forks."""

import csv
import io
from uuid import UUID

import pytest
import reports
from answers import detail

from microcosmos.archive import columns, creature
from microcosmos.spec import parse
from microcosmos_server.attempts.claim import claim
from microcosmos_server.auth.authorize import SHARE_HEADER
from microcosmos_server.phylogenies import births
from microcosmos_server.runs.submission import submit
from microcosmos_server.tables import Elite, Run


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

    def write(*generations, run=run_id, first=1):
        if run not in attempts:
            attempts[run] = claim(services, run, "worker")
        for number, elites in enumerate(generations, first):
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


def test_the_tree_as_of_a_generation_is_the_one_that_it_was(api, run_id, write):
    write([(1, 5, ()), (2, 6, ())])
    paths = [f"runs/{run_id}/phylogeny{ending}" for ending in ("", ".csv", ".nwk")]
    before = [api.get(path).content for path in paths]
    write([(3, 5, (1,))], first=2)
    assert [api.get(path).content for path in paths] != before
    asked = {"generation": 1}
    assert [api.get(path, params=asked).content for path in paths] == before


@pytest.mark.postgresql
def test_what_became_of_initial_creatures_later_is_not_in_an_earlier_tree(
    api, run_id, write, start_from, upload
):
    upload(reports.identity(7), reports.report(1, {7: 7.0}).elites[0].measured, None)
    write([(2, 5, ())], [(8, 5, ())])
    fork = start_from(2, 7)
    write([(2, 5, ())], run=fork)
    paths = [f"runs/{fork}/phylogeny{ending}" for ending in ("", ".csv", ".nwk")]
    before = [api.get(path) for path in paths]
    # One loses its cell, the other enters the archive.
    write([(3, 5, (2,)), (7, 9, ())], run=fork, first=2)
    after = [api.get(path, params={"generation": 1}) for path in paths]
    assert [one.content for one in after] == [one.content for one in before]
    assert [one.headers["etag"] for one in after] == [one.headers["etag"] for one in before]
    assert "at most 2" in detail(api.get(paths[0], params={"generation": 3}), 422)


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
def test_initial_creatures_are_elites_of_a_run_that_holds_them(
    api, run_id, write, start_from, upload
):
    upload(reports.identity(7))
    write([(1, 5, ()), (2, 6, ())], [(8, 6, ())])
    fork = start_from(7, 2, 1)
    write([(7, 1, ()), (2, 9, ()), (1, 3, ())], [(3, 3, (2,))], run=fork)
    text = api.get(f"runs/{fork}/phylogeny.csv").text
    rows = {row["taxon_label"]: row for row in csv.DictReader(io.StringIO(text))}
    fields = ("run", "generation", "fitness", "destruction_time")
    found = {number: tuple(rows[name(number)][one] for one in fields) for number in (1, 2, 7)}
    assert found == {
        1: (str(run_id), "1", "1.0", "inf"),  # The older run holds it still.
        2: (str(run_id), "1", "2.0", "inf"),
        7: (str(fork), "1", "7.0", "inf"),
    }
    # The fork begins with the births at 1.
    assert (rows[name(7)]["origin_time"], rows[name(3)]["origin_time"]) == ("2", "3")
    for number in (1, 2):
        text = api.get(f"creatures/{name(number)}/phylogeny.csv").text
        rows = {row["taxon_label"]: row for row in csv.DictReader(io.StringIO(text))}
        assert rows[name(number)]["destruction_time"] == "inf"


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
        assert statements(births.entered, session, run, run.generation) == 3


@pytest.fixture
def shared(api, write):
    """A share of the second of three generations."""
    write([(1, 5, ())], [(2, 5, (1,))], [(3, 5, (2,))])
    slug = api.post("shares", json={"creature": name(2)}).json()["slug"]
    return lambda path: api.get(path, headers={SHARE_HEADER: slug})


def test_a_share_shows_the_ancestors_of_its_creature_alone(shared, run_id):
    answer = shared(f"creatures/{name(2)}/phylogeny")
    header, arrays = columns.load(answer.content)
    assert [bytes(row).hex() for row in arrays["creature"]] == [name(1), name(2)]
    assert arrays["links"].tolist() == [[1, 0]]
    assert header["runs"] == []
    text = shared(f"creatures/{name(2)}/phylogeny.csv").text
    assert str(run_id) not in text


def test_a_share_shows_no_tree_of_others(shared, run_id):
    assert shared(f"creatures/{name(1)}/phylogeny").status_code == 404
    assert shared(f"runs/{run_id}/phylogeny").status_code == 403
