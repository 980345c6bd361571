"""Forking a run, and extending it."""

from concurrent.futures import ThreadPoolExecutor
from uuid import UUID

import httpx
import pytest
import reports
from answers import detail, fields
from deletion import delete_for_good
from sqlalchemy import select

from microcosmos.archive import creature
from microcosmos.spec import parse
from microcosmos_server.attempts.claim import claim
from microcosmos_server.core import database
from microcosmos_server.forks import routes
from microcosmos_server.runs.submission import submit
from microcosmos_server.tables import InitialCreature


@pytest.fixture
def ended(run_id, attempt, record):
    """A run of three generations: elites in cells 0 to 2, the first one replaced."""
    record(1, {0: 1.0, 1: 2.0})
    record(2, {0: 3.0}, (0.5, 0.5))
    record(3, {2: 4.0}, (0.9, 0.9))
    attempt.finish()
    return run_id


@pytest.fixture
def fork(api, ended):
    def send(start, **sent):
        headers = sent.pop("headers", {})
        return api.post(f"runs/{ended}/fork", json={"from": start, **sent}, headers=headers)

    return send


def names(identity, *numbers):
    return sorted(creature.name(identity(number)) for number in numbers)


@pytest.mark.parametrize(
    ("start", "generation", "numbers"),
    [
        ({"archive": True}, None, (1001, 2000, 3002)),
        ({"archive": True}, 1, (1000, 1001)),
        ({"cells": [0]}, None, (2000,)),
        ({"cells": [0, 1]}, 1, (1000, 1001)),
        ({"region": {"bending_effort": [0.4, 0.6]}}, None, (2000,)),
        ({"region": {"bending_effort": [0, 1], "stretching_effort": [0.8, 1]}}, None, (3002,)),
    ],
)
def test_a_fork_starts_from_the_chosen_elites(fork, identity, start, generation, numbers):
    answer = fork(start, **({} if generation is None else {"generation": generation}))
    assert answer.status_code == 202
    assert answer.json()["spec"]["search"]["initial"] == names(identity, *numbers)
    assert answer.json()["forked_from"]["creatures"] == len(numbers)


def test_a_fork_takes_the_spec_with_the_patch(fork, api, ended, services, identity):
    patch = {"world": {"viscosity": 0.2}, "search": {"batch": 8, "stop": {"fitness": 5.0}}}
    run = fork({"cells": [1]}, spec=patch, name=" Thicker ").json()
    spec = api.get(f"runs/{ended}").json()["spec"]
    spec["world"]["viscosity"] = 0.2
    spec["search"] |= {"batch": 8, "initial": names(identity, 1001)}
    spec["search"]["stop"]["fitness"] = 5.0
    assert run["spec"] == spec
    assert (run["name"], run["status"]) == ("Thicker", "queued")
    assert run["forked_from"] == {"run": str(ended), "creatures": 1}
    assert api.get(f"runs/{ended}").json()["forked_from"] is None
    (file,) = claim(services, UUID(run["id"]), "worker").initial()
    assert creature.parse(file)["sha256"] == names(identity, 1001)[0]


def test_null_clears_an_optional_field():
    """The form sends null for a bend that is not limited; the default limits it."""
    before = parse({"experiment": "quality-diversity"}).model_dump(mode="json")
    patch = {
        "control": {"max_bend": None, "period": None, "nobody": None},
        "search": {"stop": None},
    }
    document = routes.with_nulls(routes.patched(before, patch), before, patch, parse)
    spec = parse(document).model_dump(mode="json")
    assert before["control"]["max_bend"] is not None
    assert spec == {**before, "control": {**before["control"], "max_bend": None}}
    assert "period" not in document["control"]


@pytest.mark.parametrize(
    ("start", "spec", "field"),
    [
        ({}, {}, "from"),
        ({"archive": True, "cells": [1]}, {}, "from"),
        ({"cells": [7]}, {}, "from.cells"),
        ({"region": {"turning": [0, 1]}}, {}, "from.region.turning"),
        ({"region": {"bending_effort": [7, 8]}}, {}, "from.region"),
        ({"creatures": ["ab" * 32]}, {}, "search.initial"),
        ({"archive": True}, {"world": {"viscosity": -1}}, "world.viscosity"),
        ({"archive": True}, {"control": {"timer": "linear"}}, "control.inputs"),
        ({"archive": True}, {"experiment": "gaits"}, "experiment"),
    ],
)
def test_an_invalid_fork_is_refused_with_its_field(fork, api, start, spec, field):
    answer = fork(start, spec=spec)
    assert answer.status_code == 422
    assert field in [error["field"] for error in answer.json()["errors"]]
    assert len(api.get("runs").json()["items"]) == 1


def test_a_generation_that_the_run_does_not_have_is_refused(fork, api, ended):
    named = {"creatures": ["ab" * 32]}
    answers = [fork(start, generation=4) for start in ({"archive": True}, named)]
    path = f"runs/{ended}/archive"
    answers.append(api.get(path, params={"generation": 4}))
    answers.append(api.get(f"{path}/poses", params={"generation": 4, "cells": "1"}))
    for answer in answers:
        assert detail(answer, 422).startswith("generation: needs at most 3, the run's last")
    assert api.get(path, params={"generation": 3}).json()["generation"] == 3


def test_the_same_key_is_the_same_fork_after_more_generations(api, run_id, attempt, record):
    record(1, {0: 1.0})
    asked = {"json": {"from": {"archive": True}}, "headers": {"Idempotency-Key": "a key"}}
    first = api.post(f"runs/{run_id}/fork", **asked)
    record(2, {1: 2.0})
    attempt.finish()
    second = api.post(f"runs/{run_id}/fork", **asked)
    assert (first.status_code, second.status_code) == (202, 200)
    api.delete(f"runs/{run_id}")
    third = api.post(f"runs/{run_id}/fork", **asked)
    assert first.json()["id"] == second.json()["id"] == third.json()["id"]
    other = first.json()["id"]
    assert api.post(f"runs/{other}/fork", **asked).status_code == 422


def test_a_spec_with_initial_creatures_is_submitted(api, ended, spec, identity):
    initial = names(identity, 2000)
    search = {**spec["search"], "initial": initial}
    assert api.post("runs", json={**spec, "search": search}).status_code == 202
    answer = api.post("runs", json={**spec, "search": {**search, "initial": ["cd" * 32]}})
    assert fields(answer)[0] == "search.initial"


def test_initial_creatures_of_a_fork_outlive_their_run(fork, api, services, ended, identity):
    kept, gone = names(identity, 2000)[0], names(identity, 3002)[0]
    forked = fork({"creatures": [kept]}).json()["id"]
    delete_for_good(api, services, ended)
    assert api.get(f"creatures/{kept}").status_code == 200
    assert api.get(f"creatures/{gone}").status_code == 404
    assert api.get(f"runs/{forked}").json()["forked_from"] == {"run": None, "creatures": 1}
    api.post(f"runs/{forked}/cancel")
    delete_for_good(api, services, UUID(forked))
    assert api.get(f"creatures/{kept}").status_code == 404
    with services.sessions.read() as session:
        assert session.scalars(select(InitialCreature.creature)).all() == []


@pytest.fixture
def run_id(services) -> UUID:
    """A queued run of four generations."""
    demo = reports.DEMO.model_dump(mode="json")
    demo["search"]["generations"] = 4
    return submit(services, parse(demo))[0].id


@pytest.fixture
def end(record, request):
    def end(generations, summary=None):
        for generation in range(1, generations + 1):
            record(generation, {generation: 1.0}, summary=summary)
        attempt = request.getfixturevalue("attempt")
        attempt.save(generations, b"state after %d" % generations)
        attempt.finish()

    return end


def test_a_finished_run_is_queued_again_and_goes_on_where_it_ended(
    api, services, run_id, report, waiting, end
):
    end(4)
    answer = api.post(f"runs/{run_id}/extend", json={"generations": 3})
    assert answer.status_code == 202
    run = answer.json()
    assert (run["status"], run["generation"], run["generations"]) == ("queued", 4, 7)
    assert run["spec"]["search"]["generations"] == 7
    assert run["finished_at"] is None
    assert waiting() == [str(run_id)]
    attempt = claim(services, run_id, "worker")
    assert (attempt.generation, attempt.restore()) == (4, b"state after 4")
    assert attempt.spec["search"]["generations"] == 7
    attempt.record(report(5), 1.0)
    assert len(api.get(f"runs/{run_id}/generations").json()["generation"]) == 5
    texts = [entry["text"] for entry in api.get(f"runs/{run_id}/log").json()["entries"]]
    assert "Extended by 3 generations to 7: queued again." in texts


def test_a_longer_run_needs_the_memory_of_one_that_long(api, run_id, spec, row, end):
    end(4)
    before = row().memory_bytes
    assert extended(api, run_id, 100_000).status_code == 202
    spec["search"]["generations"] = 4 + 100_000
    needed = api.post("runs/estimate", json=spec).json()["memory_bytes"]
    assert row().memory_bytes == needed > before


@pytest.mark.postgresql
def test_one_of_many_concurrent_extensions_succeeds(api, run_id, row, end):
    end(2)
    with ThreadPoolExecutor(8) as pool:
        answers = list(pool.map(lambda _: extended(api, run_id), range(8)))
    assert sorted(answer.status_code for answer in answers) == [202] + 7 * [409]
    assert row().generations == 5
    refused = next(answer for answer in answers if answer.status_code == 409)
    expected = "Cannot extend this run: it is queued; it must be finished"
    assert refused.json()["detail"] == expected


def extended(api, run_id, generations=1):
    return api.post(f"runs/{run_id}/extend", json={"generations": generations})


def test_only_a_finished_run_short_of_its_goal_is_extended(api, run_id, end):
    queued = "Cannot extend this run: it is queued; it must be finished"
    assert detail(extended(api, run_id), 409) == queued
    end(2, summary={"ended.fitness": 2})
    assert "`search.stop.fitness` ended the run after generation 2" in detail(
        extended(api, run_id), 409
    )


def test_the_number_of_generations_is_checked(api, run_id, row, end):
    end(1)
    for sent in ({"generations": 0}, {"generations": "many"}, {}, {"more": 1}):
        answer = api.post(f"runs/{run_id}/extend", json=sent)
        assert fields(answer)[0] in ("generations", "more")
    assert fields(extended(api, run_id, 1_000_000))[0] == "search.generations"
    assert row().generations == 4


def test_a_request_holds_one_connection_at_a_time(serve, ended, identity, monkeypatch):
    """With two, as many requests at once as there are connections wait for each other."""
    only_one = {"pool_size": 1, "max_overflow": 0, "pool_timeout": 5}
    monkeypatch.setattr(database, "POOL", only_one)
    (name,) = names(identity, 1001)
    with serve() as address, httpx.Client(base_url=f"{address}/api/v1", timeout=30) as client:
        sent = {"from": {"archive": True}}
        assert client.post(f"runs/{ended}/fork", json=sent).status_code == 202
        for order in ("audit", "measurement"):
            assert client.post(f"creatures/{name}/{order}").status_code == 202
