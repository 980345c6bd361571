"""Every request is exactly what the API asks for."""

import hashlib
import json
from datetime import UTC, datetime, timedelta
from math import nan
from uuid import UUID

import httpx
import made_archives
import numpy as np
import pytest

from microcosmos.client import Client, NoAnswer, Refused, Run
from microcosmos.client.creature import Creature
from microcosmos.client.errors import NotMicrocosmos
from microcosmos.client.run import extra, opened
from microcosmos.exports.formats import Format
from microcosmos.exports.run_file import RunFile

RUN = "0f3c1a2b-0000-4000-8000-000000000001"
SHA = "ab" * 32
SWEEP = {
    "id": "5eed0000-0000-4000-8000-000000000001",
    "name": "by viscosity",
    "cases": [
        {"values": {"world.viscosity": 0.1}, "runs": ["r1", "r2"]},
        {"values": {"world.viscosity": 0.2}, "runs": ["r3"]},
    ],
    "total": 3,
    "status_counts": {"finished": 3},
}


def sent(fake):
    """Method, path and document of the newest request."""
    return fake.requests[-1][:3]


@pytest.mark.parametrize(
    ("asked", "whence"),
    [
        ({"creatures": [SHA]}, {"creatures": [SHA]}),
        ({"cells": np.array([3, 4])}, {"cells": [3, 4]}),
        ({"region": {"turning": (0.0, 1.5)}}, {"region": {"turning": [0.0, 1.5]}}),
        ({}, {"archive": True}),
    ],
)
def test_a_run_is_forked(fake, record, asked, whence):
    path = f"runs/{record['id']}/fork"
    served = fake({("POST", path): record | {"id": "new"}})
    patch = {"world": {"viscosity": 0.3}, "stop": None}
    new = served.run(record).fork(**asked, generation=0, spec=patch, name="thicker")
    assert new.id == "new"
    document = {"from": whence, "generation": 0, "spec": patch, "name": "thicker"}
    assert sent(served) == ("POST", path, document)
    assert UUID(served.requests[-1].key)


@pytest.mark.parametrize("change", [{"experiment": "../../x"}, {"id": "/etc/x"}, {"id": ""}])
def test_a_server_cannot_choose_the_folder_of_a_file(fake, record, change):
    with pytest.raises(NotMicrocosmos, match=f"the field `{next(iter(change))}`"):
        fake({}).run(record | change)


def test_a_fork_begins_in_one_way(fake, record):
    with pytest.raises(ValueError, match="got creatures, cells"):
        fake({}).run(record).fork(creatures=[SHA], cells=[1])


def test_a_sweep_is_found_told_off_and_summed_up(fake, record):
    path = f"sweeps/{SWEEP['id']}"
    band = {name: [0.5, 1.0] for name in ("median", "low", "high", "min", "max")}
    case = {"values": {"world.viscosity": 0.1}, "generation": [1, 2], "runs": [2, 1]}
    summary = {"cases": [case | dict.fromkeys(("qd_score", "coverage", "best"), band)]}
    answers = {
        ("GET", "sweeps"): {"items": [SWEEP], "next": None},
        ("GET", path): SWEEP,
        ("POST", f"{path}/cancel"): SWEEP,
        ("POST", f"{path}/uncancel"): SWEEP,
        ("GET", f"{path}/summary"): summary,
        ("GET", "runs"): {"items": [record | {"id": "r3"}], "next": None},
    }
    served = fake(answers)
    sweep = served.client.sweep("5eed")
    assert sweep.ended
    assert sweep.cancel().total == 3
    assert served.requests[-2][:2] == ("POST", f"{path}/cancel")
    sweep.uncancel()
    assert served.requests[-2][:3] == ("POST", f"{path}/uncancel", {"runs": []})
    rows = sweep.summary().rows()
    assert len(rows) == 6
    expected = {"world.viscosity": 0.1, "generation": 2, "measure": "qd_score", "runs": 1}
    assert rows[1] == expected | dict.fromkeys(band, 1.0)
    (row,) = sweep.rows()
    assert (row["world.viscosity"], row["seed"], row["run"]) == (0.2, 4, "r3")
    assert served.requests[-1].query["sweep"] == SWEEP["id"]
    assert sweep.watch() == {"finished": 3}


def test_a_link_has_the_credit_and_the_end_that_it_was_given(fake):
    answers = {("POST", "shares"): {"slug": "s1", "url": "/s/s1", "title": "Eel"}}
    served = fake(answers | {("GET", f"creatures/{SHA}"): {"sha256": SHA}})
    before = datetime.now(UTC)
    found = served.client.creature(SHA).share(title="Eel", credit="Ada", days=2)
    assert found.url == "http://fake/s/s1"
    document = dict(served.requests[-1].document)
    expires = datetime.fromisoformat(document.pop("expires_at"))
    assert timedelta(days=2) <= expires - before < timedelta(days=2, minutes=5)
    expected = {"creature": SHA, "title": "Eel", "credit": "Ada", "listed": False}
    assert document == expected


def test_a_creature_is_brought_and_saved(fake, tmp_path):
    file = {"sha256": SHA, "measured": None, "identity": {}}
    answers = {
        ("POST", "creatures"): {"creature": SHA},
        ("GET", f"creatures/{SHA}"): file,
        ("GET", f"creatures/{SHA}/film.gif"): httpx.Response(200, content=b"GIF89a"),
    }
    served = fake(answers)
    creature = served.client.import_creature(file)
    assert sent(served) == ("POST", "creatures", file)
    assert creature.fitness is None
    saved = creature.save(tmp_path / "one.json")
    assert served.client.import_creature(saved) == creature
    assert sent(served) == ("POST", "creatures", file)
    assert creature.save(tmp_path / "one.GIF").read_bytes() == b"GIF89a"
    with pytest.raises(ValueError, match=r"got one\.bmp"):
        creature.save(tmp_path / "one.bmp")


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (lambda client, run: run.change(tags="abc"), "`tags` must be a list; got 'abc'"),
        (lambda client, run: run.extend(True), "`generations` must be a whole number"),
        (lambda client, run: run.extend("1"), "`generations` must be a whole number"),
        (lambda client, run: run.choose(SHA), "`creatures` must be a list"),
        (lambda client, run: run.choose(["../runs"]), "`creatures` must be the 64 hexadecimal"),
        (lambda client, run: run.fork(creatures=SHA), "`creatures` must be a list"),
        (lambda client, run: run.fork(cells="12"), "`cells` must be a list"),
        (lambda client, run: run.fork(cells=["1"]), "`cells` must be whole numbers"),
        (lambda client, run: run.fork(spec="small.json"), "`spec` must be fields by name"),
        (lambda client, run: run.fork(region={"a": "01"}), "`region.a` must be two finite"),
        (lambda client, run: run.fork(region={"a": (0, nan)}), "`region.a` must be two finite"),
        (lambda client, run: run.fork(spec={"a": {"b": nan}}), "`spec.a.b` must be a finite"),
        (lambda client, run: run.history("speed"), "`measures` must be a list; got 'speed'"),
        (lambda client, run: run.phylogeny("../log"), "`form` must be csv or nwk"),
        (
            lambda client, run: client.submit({}, seeds=[]),
            "`seeds` must be a number, or a list",
        ),
        (lambda client, run: client.submit({}, seeds=True), "`seeds` must be a whole number"),
        (lambda client, run: client.submit({}, seeds="12"), "`seeds` must be a list"),
        (lambda client, run: client.submit({}, grid={"a.b": 0.1}), "`grid.a.b` must be a list"),
        (lambda client, run: client.submit({"a": [np.nan]}), "`a.0` must be a finite number"),
        (lambda client, run: client.submit({}, key="a\r"), "`key` must be ASCII"),
        (lambda client, run: client.creature("../runs"), "`sha` must be the 64 hexadecimal"),
        (lambda client, run: client.share(5), "`what` must be a run, a creature or its name"),
        (lambda client, run: client.share(SHA, days="3"), "`days` must be a number"),
        (lambda client, run: client.unshare(".."), "`slug` must be that of a share"),
        (lambda client, run: client.submit(5), "`spec` must be a spec, a file or a preset"),
        (lambda client, run: client.estimate(None), "`spec` must be a spec, a file or a"),
        (lambda client, run: client.submit({"a": {1}}), "`a` must be text, a number, a list"),
        (lambda client, run: client.submit({}, key=5), "`key` must be ASCII"),
        (lambda client, run: client.runs(status=5), "`status` must be a list; got 5"),
        (lambda client, run: client.runs(experiment=5), "`experiment` must be a list; got 5"),
        (lambda client, run: client.import_creature(5), "`file` must be a creature file"),
        (lambda client, run: next(client.import_all(5)), "`address` must be that of a share"),
        (lambda client, run: run.wait(timeout=nan), "`timeout` must be a number of at least 0"),
        (
            lambda client, run: Creature(client.connection, SHA).replay(timeout=nan),
            "`timeout` must be a number of at least 0",
        ),
    ],
)
def test_arguments_of_another_kind_are_refused_by_name(fake, record, given, words):
    served = fake({})
    client = served.client
    with pytest.raises(ValueError, match=words):
        given(client, Run(client.connection, record))
    assert not served.requests


def test_a_crate_has_the_best_creature_of_its_file(fake, record):
    """The run on the server has gone on."""
    file, best = RunFile("run", made_archives.made()), bytes(range(64, 96)).hex()
    path = f"runs/{record['id']}"
    problem = {"content-type": "application/problem+json"}
    none = httpx.Response(404, headers=problem, json={"detail": "Nobody chose."})
    answers = {("GET", f"creatures/{best}"): {"sha256": best}}
    served = fake(answers | {("GET", f"{path}/choices.json"): none})
    found = extra(served.run(record), file)
    assert json.loads(found["best.json"].data) == {"sha256": best}


@pytest.mark.parametrize(("name", "title"), [("Eels", "Eels"), (None, "")])
def test_an_opened_run_has_its_name_as_the_title_of_a_crate(fake, record, name, title):
    data = made_archives.made()
    tagged = {"etag": f'"{hashlib.sha256(data).hexdigest()}"'}
    sent = httpx.Response(200, headers=tagged, stream=httpx.ByteStream(data))
    served = fake({("GET", f"runs/{record['id']}/archive.h5"): sent})
    run = served.run(record | {"name": name, "finished_at": None})
    assert opened(run, Format.parquet, quiet=True).title == title


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"patience": nan}, "`patience` must be a number of at least 0; got nan"),
        ({"url": 5}, "`url` must be an address"),
        ({"token": 5}, "`token` must be ASCII"),
    ],
)
def test_a_client_of_another_kind_is_refused_by_name(given, words):
    with pytest.raises(ValueError, match=words):
        Client(**given)


@pytest.mark.parametrize(("given", "tries"), [({}, 3), ({"patience": 9000.0}, 1200)])
def test_patience_holds_before_a_first_answer_where_it_is_given(given, tries, monkeypatch):
    asked = []

    def absent(request):
        asked.append(request)
        raise httpx.ConnectError("refused")

    monkeypatch.setattr("time.sleep", lambda seconds: None)
    monkeypatch.setattr("random.uniform", lambda low, high: 0.9)
    client = Client("http://absent", transport=httpx.MockTransport(absent), **given)
    with pytest.raises(NoAnswer):
        client.last()
    assert tries <= len(asked) <= 1.1 * tries


def test_an_id_is_a_text(fake):
    with pytest.raises(Refused, match="needed as a text; got 5"):
        fake({}).client.run(5)


def test_ids_of_runs_and_events_may_be_short(fake, record):
    stream = httpx.Response(200, content=b"event: start\ndata: {}\n\n")
    answers = {("GET", path): {"items": [], "next": None} for path in ("runs", "sweeps")}
    answers["GET", "sweeps"]["items"] = [SWEEP]
    served = fake(answers)
    assert list(served.client.runs(sweep=SWEEP["id"][:8])) == []
    assert served.requests[-1].query["sweep"] == SWEEP["id"]
    answers["GET", "runs"]["items"] = [record]
    served = fake(answers | {("GET", "events"): stream})
    assert next(served.client.events(RUN[:8])).kind == "start"
    assert served.requests[-1].query["run"] == RUN


def test_numbers_of_numpy_are_sent_as_numbers(fake, record):
    sweep = {"id": RUN, "cases": [], "total": 2, "status_counts": {}}
    answers = {("POST", f"runs/{RUN}/{do}"): record for do in ("extend", "fork")}
    served = fake(answers | {("POST", "sweeps"): sweep})
    run = served.run(record)
    run.extend(np.int64(2))
    run.fork(region={"a": np.array([0.5, 1])})
    grid = {"a.b": np.array([0.5, 2])}
    served.client.submit({}, seeds=np.int64(2), grid=grid)
    served.client.submit({}, seeds=np.arange(2))
    extended, forked, counted, listed = (one.document for one in served.requests)
    assert extended == {"generations": 2}
    assert forked["from"] == {"region": {"a": [0.5, 1.0]}}
    assert counted == {"spec": {}, "seeds": 2, "grid": {"a.b": [0.5, 2.0]}}
    assert listed["seeds"] == [0, 1]


def test_a_run_that_began_again_between_two_requests_is_read_again():
    """A lost worker had recorded generation 9; the next began at the checkpoint of 4."""
    problem = {"content-type": "application/problem+json"}
    wrong = {"detail": "No.", "errors": [{"field": "generation", "reason": "needs at most 4"}]}
    elites = {name: [] for name in ("cell", "fitness", "descriptors", "elite_generation")}
    found = {"kind": "grid", "cells": 4, "coverage": 0.0, "axes": [], "creature": []}
    found |= elites | {"trusted": [], "measures": {}, "recorded": [{"name": "speed"}]}
    answers = [
        httpx.Response(200, json=found | {"generation": 9}),
        httpx.Response(422, headers=problem, json=wrong),
        *(httpx.Response(200, json=found | {"generation": 4}) for _ in range(2)),
    ]
    transport = httpx.MockTransport(lambda _: answers.pop(0))
    connection = Client("http://fake", transport=transport).connection
    assert Run(connection, {"id": RUN}).archive().generation == 4
