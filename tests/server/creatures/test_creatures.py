"""Creatures: reading by name, uploading, and replays."""

import json
from concurrent.futures import ThreadPoolExecutor

import httpx
import pytest
from answers import detail, errors, fields
from rq import SimpleWorker
from rq.serializers import JSONSerializer

from microcosmos.archive import creature
from microcosmos.naming import LICENCE
from microcosmos_server.core.database import insert_missing
from microcosmos_server.creatures import storage
from microcosmos_server.tables import Creature
from microcosmos_worker import jobs


def test_an_elite_is_read_as_a_creature_file(api, attempt, record, report):
    found = report(2, {7: 1.25})
    record(1)
    attempt.record(found, 1.0)
    (elite,) = found.elites
    answer = api.get(f"creatures/{elite.creature}")
    document = answer.json()
    assert document["identity"] == json.loads(elite.identity)
    assert document["measured"]["fitness"] == 1.25
    assert document["measured"] == elite.measured
    assert document["provenance"] == elite.provenance
    assert creature.parse(document)["sha256"] == elite.creature


@pytest.mark.postgresql
def test_an_import_that_waits_for_a_run_inserting_the_same_creature_keeps_it(
    api, services, file
):
    """What is imported is never deleted, what only a run has found is, with the run."""
    identity = creature.canonical(file["identity"])
    row = storage.creature_columns(file["sha256"], identity, None, None, LICENCE)
    with ThreadPoolExecutor(1) as pool, services.sessions.write.begin() as session:
        insert_missing(session, Creature, [row])
        session.flush()
        answer = pool.submit(api.post, "creatures", json=file)
        with pytest.raises(TimeoutError):
            answer.result(0.5)  # It waits for this transaction.
        session.commit()
        assert answer.result(20).is_success
    with services.sessions.read() as session:
        assert session.get_one(Creature, file["sha256"]).imported


def test_a_downloaded_creature_can_be_uploaded_again(api, known):
    answer = api.get(f"creatures/{known}", params={"download": 1})
    assert f'filename="creature-{known[:12]}.json"' in answer.headers["content-disposition"]
    again = api.post("creatures", content=answer.content)
    assert (again.status_code, again.json()) == (200, {"creature": known})
    file = api.get(f"creatures/{known}/creature.h5").content
    sent = {"Content-Type": "application/x-hdf5"}
    again = api.post("creatures", content=file, headers=sent)
    assert (again.status_code, again.json()) == (200, {"creature": known})
    types = [{}, {"Accept": "application/x-hdf5"}, {"Accept": "application/octet-stream"}]
    sent = [api.get(f"creatures/{known}/creature.h5", headers=one) for one in types]
    assert {one.content for one in sent} == {file}
    told = [one.headers["content-type"] for one in sent]
    assert told == ["application/x-hdf5", "application/x-hdf5", "application/octet-stream"]
    known_already = {"If-None-Match": answer.headers["etag"]}
    answer = api.get(f"creatures/{known}", headers=known_already)
    assert (answer.status_code, answer.content) == (304, b"")


def test_a_creature_that_came_back_with_another_licence_is_sent_anew(api, known, update_rows):
    before = api.get(f"creatures/{known}")
    update_rows(Creature, licence="CC-BY-NC-4.0")
    after = api.get(f"creatures/{known}", headers={"If-None-Match": before.headers["etag"]})
    assert (after.status_code, after.json()["licence"]) == (200, "CC-BY-NC-4.0")


def test_an_uploaded_creature_is_kept_whole(api, file):
    file["measured"] = {
        "fitness": 1.5,
        "descriptors": {"bending_effort": 0.25},
        "measures": {"displacement": 1.5, "bending_effort": 0.25},
        "block": 16,
        "room": [24, 64],
        "device": "elsewhere",
    }
    file["provenance"] = {
        "parents": ["ab" * 32],
        "operator": "neat",
        "generation": 4,
        "seed": 1,
        "version": "0.1.0",
    }
    answer = api.post("creatures", json=file)
    assert (answer.status_code, answer.json()) == (201, {"creature": file["sha256"]})
    assert answer.headers["location"] == f"/api/v1/creatures/{file['sha256']}"
    assert api.get(f"creatures/{file['sha256']}").json() == file


def test_a_wrong_hash_is_refused_with_the_right_one(api, file):
    right, wrong = file["sha256"], "00" * 32
    (error,) = errors(api.post("creatures", json={**file, "sha256": wrong}))
    assert (error["field"], error["got"]) == ("sha256", wrong)
    assert right in error["needed"]


def test_an_upload_without_a_length_is_limited_while_it_streams(api):
    body = (b" " * (1 << 16) for _ in range(1000))
    assert api.post("creatures", content=body).status_code == 413


def test_a_rendering_that_failed_says_why(api, services, known, monkeypatch):
    def refuse():
        raise ValueError("it takes too much memory\nin many lines")

    monkeypatch.setattr(jobs, "prepare_job", refuse)
    assert api.get(f"creatures/{known}/replay").status_code == 202
    SimpleWorker([services.jobs.renderings], serializer=JSONSerializer).work(burst=True)
    answer = api.get(f"creatures/{known}/replay")
    assert "failed: ValueError: it takes too much memory. Try again" in detail(answer, 500)
    assert answer.headers["retry-after"]


def test_a_replay_cannot_be_ordered_without_redis(served, known):
    address = served(redis_url="redis://127.0.0.1:1/0")
    answer = httpx.get(f"{address}/api/v1/creatures/{known}/replay", timeout=20)
    assert detail(answer, 503) == "Redis does not answer; try again."
    assert answer.headers["retry-after"]


def test_a_lost_order_is_given_again(api, services, known, flush):
    api.get(f"creatures/{known}/replay")
    flush()
    assert api.get(f"creatures/{known}/replay").status_code == 202
    assert services.jobs.renderings.count == 1


@pytest.fixture
def family(identity) -> list[dict]:
    def one(number: int, *parents: dict) -> dict:
        origin = {"operator": "neat", "generation": number, "seed": 1, "version": "0.1.0"}
        names = [parent["sha256"] for parent in parents]
        return creature.document(identity(number), None, {"parents": names, **origin})

    oldest = one(1)
    parent = one(2, oldest)
    return [one(3, parent), parent, oldest]


def test_an_upload_keeps_ancestors_with_credit_and_licence(api, family):
    young, parent, oldest = family
    oldest |= {"credit": ["Ada"], "licence": "CC0-1.0"}
    whole = {**young, "ancestors": [parent, oldest]}
    assert api.post("creatures", json=whole).status_code == 201
    query = {"ancestors": True, "download": True}
    answer = api.get(f"creatures/{young['sha256']}", params=query)
    assert answer.json() == whole, "and can be handed on as it came"
    assert "attachment" in answer.headers["content-disposition"]
    ancestors = api.get(f"creatures/{young['sha256']}/ancestors").json()["items"]
    assert [(one["creature"], one["stored"]) for one in ancestors] == [
        (parent["sha256"], True),
        (oldest["sha256"], True),
    ]
    assert (ancestors[1]["credit"], ancestors[1]["licence"]) == (["Ada"], "CC0-1.0")


def test_false_ancestors_are_refused_and_nothing_is_kept(api, family, identity):
    young, parent, oldest = family
    stranger = creature.document(identity(9), None, None)
    cases = [
        ([stranger], "ancestors.0"),
        ([parent, young], "ancestors.1"),
        ([oldest], "ancestors.0"),
        ([{**parent, "sha256": "00" * 32}], "ancestors.0.sha256"),
        ([parent] * 201, "ancestors"),
        ("none", "ancestors"),
    ]
    for ancestors, field in cases:
        assert fields(api.post("creatures", json={**young, "ancestors": ancestors}))[0] == field
    assert api.get(f"creatures/{young['sha256']}").status_code == 404
