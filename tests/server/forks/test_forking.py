"""A new run that begins from creatures of another."""

from uuid import UUID

import pytest
from sqlalchemy import select, update

from microcosmos.archive import creature
from microcosmos.spec import parse
from server.attempts.claim import claim
from server.deletion.purge import purge
from server.forks import forking
from server.tables import InitialCreature, Run


@pytest.fixture
def ended(services, run_id, report):
    """A run of three generations: cells 0 to 2, the first taken again by a later elite."""
    attempt = claim(services, run_id, "worker")
    attempt.record(report(1, {0: 1.0, 1: 2.0}), 1.0)
    attempt.record(report(2, {0: 3.0}, (0.5, 0.5)), 1.0)
    attempt.record(report(3, {2: 4.0}, (0.9, 0.9)), 1.0)
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
def test_it_begins_from_those_who_live_there(fork, identity, start, generation, numbers):
    answer = fork(start, **({} if generation is None else {"generation": generation}))
    assert answer.status_code == 202
    assert answer.json()["spec"]["search"]["initial"] == names(identity, *numbers)
    assert answer.json()["forked_from"]["creatures"] == len(numbers)


def test_the_rest_of_the_spec_is_the_other_runs_but_for_the_patch(
    fork, api, ended, services, identity
):
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


def test_null_takes_a_choice_back_to_its_default(fork):
    run = fork({"archive": True}, spec={"control": {"period": None}}).json()
    assert run["spec"]["control"]["period"] != 50


def test_null_is_none_where_there_can_be_none():
    """As the form says that lengths are not driven: their default would drive them."""
    grown = {"experiment": "quality-diversity", "control": {"encoding": "cppn-body"}}
    before = parse(grown).model_dump(mode="json")
    patch = {
        "control": {"rest_length": None, "period": None, "nobody": None},
        "search": {"stop": None},
    }
    document = forking.emptied(forking.patched(before, patch), before, patch, parse)
    spec = parse(document).model_dump(mode="json")
    assert before["control"]["rest_length"] is not None
    assert spec == {**before, "control": {**before["control"], "rest_length": None}}
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
        ({"archive": True}, {"control": {"timer": "linear"}}, "control: inputs"),
        ({"archive": True}, {"experiment": "gaits"}, "experiment"),
    ],
)
def test_what_cannot_be_is_refused_with_its_field(fork, api, start, spec, field):
    answer = fork(start, spec=spec)
    assert answer.status_code == 422
    assert field in [error["field"] for error in answer.json()["errors"]]
    assert len(api.get("runs").json()["items"]) == 1


def test_the_same_key_is_the_same_fork(fork):
    headers = {"Idempotency-Key": "a key"}
    first, second = (fork({"cells": [1]}, headers=headers) for _ in range(2))
    assert (first.status_code, second.status_code) == (202, 200)
    assert first.json()["id"] == second.json()["id"]
    assert fork({"cells": [2]}, headers=headers).status_code == 422


def test_the_same_key_is_the_same_fork_though_the_run_went_on(api, services, run_id, report):
    attempt = claim(services, run_id, "worker")
    attempt.record(report(1, {0: 1.0}), 1.0)
    asked = {"json": {"from": {"archive": True}}, "headers": {"Idempotency-Key": "a key"}}
    first = api.post(f"runs/{run_id}/fork", **asked)
    attempt.record(report(2, {1: 2.0}), 1.0)
    attempt.finish()
    second = api.post(f"runs/{run_id}/fork", **asked)
    assert (first.status_code, second.status_code) == (202, 200)
    api.delete(f"runs/{run_id}")
    third = api.post(f"runs/{run_id}/fork", **asked)
    assert first.json()["id"] == second.json()["id"] == third.json()["id"]
    other = first.json()["id"]
    assert api.post(f"runs/{other}/fork", **asked).status_code == 422


def test_a_spec_with_an_origin_can_be_submitted_as_it_is(api, ended, spec, identity):
    initial = names(identity, 2000)
    search = {**spec["search"], "initial": initial}
    assert api.post("runs", json={**spec, "search": search}).status_code == 202
    answer = api.post("runs", json={**spec, "search": {**search, "initial": ["cd" * 32]}})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["field"] == "search.initial"


def test_what_a_fork_begins_from_outlives_the_run_that_it_was_in(
    fork, api, services, ended, identity
):
    kept, gone = names(identity, 2000)[0], names(identity, 3002)[0]
    forked = fork({"creatures": [kept]}).json()["id"]
    assert api.delete(f"runs/{ended}").status_code == 200
    for_good(api, services, ended)
    assert api.get(f"creatures/{kept}").status_code == 200
    assert api.get(f"creatures/{gone}").status_code == 404
    assert api.get(f"runs/{forked}").json()["forked_from"] == {"run": None, "creatures": 1}
    api.post(f"runs/{forked}/cancel")
    api.delete(f"runs/{forked}")
    for_good(api, services, UUID(forked))
    assert api.get(f"creatures/{kept}").status_code == 404
    with services.sessions.read() as session:
        assert session.scalars(select(InitialCreature.creature)).all() == []


def for_good(api, services, run_id):
    with services.sessions.write.begin() as session:
        over = update(Run).where(Run.id == run_id)
        session.execute(over.values(purge_at=Run.deleted_at))
    purge(services)
    assert api.get(f"runs/{run_id}").status_code == 404


def test_nothing_begins_from_a_run_in_the_bin(fork, api, ended):
    api.delete(f"runs/{ended}")
    assert fork({"archive": True}).status_code == 404


def test_a_fork_comes_back_from_the_bin_though_what_it_was_forked_from_is_gone(
    fork, api, services, ended, identity
):
    forked = UUID(fork({"cells": [1]}).json()["id"])
    api.post(f"runs/{forked}/pause")
    api.delete(f"runs/{forked}")
    assert api.delete(f"runs/{ended}").status_code == 200
    for_good(api, services, ended)
    api.post(f"runs/{forked}/restore")
    assert api.post(f"runs/{forked}/resume").json()["status"] == "queued"
    (file,) = claim(services, forked, "worker").initial()
    assert file["sha256"] == names(identity, 1001)[0]
