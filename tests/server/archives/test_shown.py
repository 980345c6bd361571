"""Answers about archives: their forms, their tags, and the bytes that the server keeps."""

import json
from concurrent.futures import ThreadPoolExecutor
from threading import Event

import httpx
import numpy as np
import pytest
import reports
from reports import audit

from microcosmos.archive import columns
from microcosmos_server.archives import reading
from microcosmos_server.attempts.claim import claim
from microcosmos_server.creatures.storage import creature_columns, insert_and_lock
from microcosmos_server.renderings import storage as renderings
from microcosmos_server.runs.submission import submit
from microcosmos_server.tables import AUDIT, Creature

MEASURES = "displacement,bending_effort"
BINARY = {"Accept": columns.MEDIA_TYPE}
COLUMN = {"name": "cell", "type": "int64", "shape": [5]}
PATHS = ("archive", "archive/history", "archive/reprojection")


def asked(path):
    return {"measures": MEASURES} | (
        {"axes": "displacement,bending_effort"} if "reproj" in path else {}
    )


def as_json(header, arrays):
    """The document that JSON has in place of these columns."""
    found = {name: values.tolist() for name, values in arrays.items()}
    found["creature"] = [bytes(sha).hex() for sha in arrays["creature"]]
    found["trusted"] = [{-1: None, 0: False, 1: True}[one] for one in found["trusted"]]
    measures = {name: found.pop(f"measures.{name}") for name in MEASURES.split(",")}
    return header | found | {"measures": measures}


@pytest.mark.parametrize("path", PATHS)
def test_columns_as_bytes_say_what_json_says(api, services, run_id, record, path):
    record(1, {5: 1.0, 3: 2.0})
    record(2, {5: 1.5, 7: 0.25}, emptied=(3,))
    url = f"runs/{run_id}/{path}"
    plain = api.get(url, params=asked(path)).json()
    renderings.save(services, plain["creature"][-1], AUDIT, audit(True))
    plain = api.get(url, params=asked(path))
    assert plain.headers["content-type"] == "application/json"
    binary = api.get(url, params=asked(path), headers=BINARY)
    assert binary.headers["content-type"] == columns.MEDIA_TYPE
    header, arrays = columns.load(binary.content)
    assert as_json(header, arrays) == plain.json()
    assert len(arrays["cell"]) > 0
    assert True in plain.json()["trusted"]


@pytest.mark.parametrize("path", PATHS)
def test_unknown_parameters_make_no_new_answer(api, run_id, record, monkeypatch, path):
    record(1, {5: 1.0, 3: 2.0})
    made = []
    name = {"archive": "archive", "archive/history": "history"}.get(path, "reprojected")
    read = getattr(reading, name)
    monkeypatch.setattr(reading, name, lambda *given: made.append(given) or read(*given))
    url = f"runs/{run_id}/{path}"
    more = [{"x": 1}, {"x": 2}, {"measures": "bending_effort,,displacement,displacement"}]
    tags = {api.get(url, params=asked(path) | one).headers["etag"] for one in more}
    assert (len(tags), len(made)) == (1, 1)


@pytest.mark.postgresql
def test_what_was_measured_here_replaces_what_a_file_says(
    api, services, run_id, record, report
):
    """The name is a hash of the identity, so a file may say anything about its measures."""
    other, (elite,) = report(1, {3: 1.0}), report(1, {5: 1.0}).elites
    claim(services, submit(services, reports.DEMO)[0].id, "other").record(other, 1.0)
    measured = elite.measured | {"measures": {"displacement": 999.0, "bending_effort": 0.1}}
    row = creature_columns(elite.creature, elite.identity, measured, None, "CC0-1.0")
    with services.sessions.write.begin() as session:
        insert_and_lock(session, [row | {"imported": True}])
    record(1, {5: 1.0})
    url = f"runs/{run_id}/archive"
    found = api.get(url, params={"measures": MEASURES}).json()["measures"]
    assert found == {name: [elite.measured["measures"][name]] for name in MEASURES.split(",")}
    # What was measured here first stays, whatever finds the creature again, and on any device.
    with services.sessions.write.begin() as session:
        insert_and_lock(session, [row])
        assert session.get_one(Creature, elite.creature).measured == elite.measured


@pytest.mark.parametrize(
    "described",
    [5, [{}], *([COLUMN | wrong] for wrong in ({"type": 3}, {"type": "f9"}, {"shape": [-1]}))],
)
def test_columns_that_are_not_described_are_refused(described):
    text = json.dumps({"format": columns.FORMAT, "columns": described}).encode()
    with pytest.raises(ValueError, match="column"):
        columns.load(columns.LENGTH.pack(len(text)) + text + bytes(40))


@pytest.mark.parametrize("cut", [0, 3, 40, -1])
def test_cut_columns_are_refused(cut):
    whole = columns.dump({}, {"cell": np.arange(5)})
    with pytest.raises(ValueError, match="column"):
        columns.load(whole[:cut])


@pytest.mark.postgresql
def test_a_tag_changes_whenever_the_answer_may(api, services, run_id, report, attempt):
    url = f"runs/{run_id}/archive"
    attempt.record(report(1, {5: 1.0}), 1.0)
    attempt.save(1, b"one")
    attempt.record(report(2, {5: 1.5}), 1.0)
    tags = [api.get(url).headers["etag"]]

    def changed_once():
        statuses = []
        for _ in range(2):
            answer = api.get(url, headers={"If-None-Match": tags[-1]})
            tags.append(answer.headers["etag"])
            statuses.append(answer.status_code)
        return statuses == [200, 304]

    assert not changed_once()
    renderings.save(services, api.get(url).json()["creature"][0], AUDIT, audit(False))
    assert changed_once()
    again = claim(services, run_id, "worker")  # It returns to the checkpoint.
    assert changed_once()
    again.record(report(2, {5: 1.5}), 1.0)
    assert changed_once()
    again.record(report(3), 1.0)
    assert changed_once()
    assert len(set(tags)) == 5


def test_every_form_and_question_has_a_tag_of_its_own(api, run_id, record):
    record(1, {5: 1.0})
    record(2, {3: 1.0})
    url, plain = f"runs/{run_id}/archive", {"Accept-Encoding": "identity"}
    questions = ({}, {"generation": 1}, {"after": 1}, {"measures": "displacement"})
    tags = [
        api.get(address, params=asked, headers=headers).headers["etag"]
        for address in (url, f"{url}/history")
        for headers in ({}, plain, BINARY, BINARY | plain)
        for asked in (questions if address == url else questions[::3])
    ]
    assert len(set(tags)) == len(tags)
    assert not any(tag.startswith("W/") for tag in tags)


@pytest.mark.parametrize(
    ("accepted", "coding"),
    [
        ("gzip", "gzip"),
        ("br, gzip;q=0.5", "gzip"),
        ("gzip;q=0", None),
        ("gzip; q=0.0, br", None),
        ("br", None),
        ("", None),
    ],
)
def test_answers_are_compressed_for_those_who_accept_it(api, run_id, record, accepted, coding):
    record(1, {5: 1.0})
    url = f"runs/{run_id}/archive"
    answer = api.get(url, headers={"Accept-Encoding": accepted})
    assert answer.headers.get("content-encoding") == coding
    assert answer.json() == api.get(url).json()


def test_many_requests_make_one_answer_and_hold_no_thread(
    api, address, run_id, record, monkeypatch
):
    """More requests wait than the server has threads, and it answers others meanwhile."""
    record(1, {5: 1.0})
    go, made, read = Event(), [], reading.archive

    def slow(*arguments):
        made.append(arguments)
        assert go.wait(60)
        return read(*arguments)

    monkeypatch.setattr(reading, "archive", slow)
    limits = httpx.Limits(max_connections=60)
    with (
        httpx.Client(base_url=str(api.base_url), timeout=60, limits=limits) as many,
        ThreadPoolExecutor(60) as pool,
    ):
        answers = [pool.submit(many.get, f"runs/{run_id}/archive") for _ in range(60)]
        try:
            while not made:
                pass
            assert api.get(f"{address}/healthz").status_code == 200
            assert api.get(f"runs/{run_id}").status_code == 200
            assert not any(one.done() for one in answers)
        finally:
            go.set()
        found = {one.result().content for one in answers}
    assert len(found) == len(made) == 1
