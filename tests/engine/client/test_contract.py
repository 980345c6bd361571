"""Every request is exactly what the API asks for."""

from datetime import UTC, datetime, timedelta
from uuid import UUID

import httpx
import numpy as np
import pytest

from microcosmos.client import Client, Share, Sweep

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


@pytest.mark.parametrize("action", ["pause", "resume", "cancel", "restore"])
def test_actions_on_a_run_are_requests(fake, record, action):
    served = fake({("POST", f"runs/{record['id']}/{action}"): record | {"status": "paused"}})
    run = served.run(record)
    assert getattr(run, action)() is run
    assert run.status == "paused"
    assert sent(served) == ("POST", f"runs/{record['id']}/{action}", None)


def test_a_run_is_extended_and_deleted(fake, record):
    path = f"runs/{record['id']}"
    gone = record | {"deleted_at": "2026-01-01T00:00:00Z"}
    served = fake({("POST", f"{path}/extend"): record, ("DELETE", path): gone})
    run = served.run(record)
    run.extend(20)
    assert sent(served) == ("POST", f"{path}/extend", {"generations": 20})
    assert run.delete().record["deleted_at"]
    assert sent(served) == ("DELETE", path, None)


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


def test_a_fork_begins_in_one_way(fake, record):
    with pytest.raises(ValueError, match="got creatures, cells"):
        fake({}).run(record).fork(creatures=[SHA], cells=[1])


def test_seeds_and_a_grid_are_a_sweep(fake):
    served = fake({("POST", "sweeps"): SWEEP})
    spec = {"experiment": "quality-diversity"}
    grid = {"world.viscosity": np.array([1, 2])}
    found = served.client.submit(spec, seeds=3, grid=grid, name="both")
    assert isinstance(found, Sweep)
    document = {"spec": spec, "seeds": 3, "grid": {"world.viscosity": [1, 2]}, "name": "both"}
    assert sent(served) == ("POST", "sweeps", document)
    assert UUID(served.requests[-1].key)
    served.client.submit(spec, seeds=[7, 9])
    assert served.requests[-1].document == {"spec": spec, "seeds": [7, 9], "grid": {}}
    served.client.submit(spec, grid={"seed": [1]})
    assert served.requests[-1].document == {"spec": spec, "seeds": 1, "grid": {"seed": [1]}}


def test_a_sweep_is_found_told_off_and_summed_up(fake, record):
    path = f"sweeps/{SWEEP['id']}"
    band = {name: [0.5, 1.0] for name in ("median", "low", "high", "min", "max")}
    case = {"values": {"world.viscosity": 0.1}, "generation": [1, 2], "runs": [2, 1]}
    summary = {"cases": [case | dict.fromkeys(("qd_score", "coverage", "best"), band)]}
    answers = {
        ("GET", "sweeps"): {"items": [SWEEP], "next": None},
        ("GET", path): SWEEP,
        ("POST", f"{path}/cancel"): SWEEP,
        ("GET", f"{path}/summary"): summary,
        ("GET", "runs"): {"items": [record | {"id": "r3"}], "next": None},
    }
    served = fake(answers)
    sweep = served.client.sweep("5eed")
    assert sweep.ended
    assert sweep.cancel().total == 3
    assert served.requests[-2][:2] == ("POST", f"{path}/cancel")
    rows = sweep.summary().rows()
    assert len(rows) == 6
    expected = {"world.viscosity": 0.1, "generation": 2, "measure": "qd_score", "runs": 1}
    assert rows[1] == expected | dict.fromkeys(band, 1.0)
    (row,) = sweep.rows()
    assert (row["world.viscosity"], row["seed"], row["run"]) == (0.2, 4, "r3")
    assert served.requests[-1].query["sweep"] == SWEEP["id"]
    assert sweep.watch() == {"finished": 3}


def test_the_bin_is_listed(fake, record):
    served = fake({("GET", "runs"): {"items": [record], "next": None}})
    assert served.client.run("0f3c", deleted=True).id == record["id"]
    assert served.requests[-1].query == {"q": "0f3c", "deleted": "true", "limit": "200"}


def test_links_are_published_listed_and_revoked(fake, record):
    share = {"slug": "s1", "url": "/s/s1", "title": "Eel"}
    answers = {
        ("POST", "shares"): share,
        ("GET", "shares"): [share],
        ("GET", "commons"): {"items": [share], "next": None},
        ("DELETE", "shares/s1"): httpx.Response(204),
        ("GET", f"creatures/{SHA}"): {"sha256": SHA},
    }
    served = fake(answers)
    client = served.client
    before = datetime.now(UTC)
    found = client.creature(SHA).share(title="Eel", credit="Ada", licence="CC0-1.0", days=2)
    assert isinstance(found, Share)
    assert found.url == "http://fake/s/s1"
    document = dict(served.requests[-1].document)
    expires = datetime.fromisoformat(document.pop("expires_at"))
    assert timedelta(days=2) <= expires - before < timedelta(days=2, minutes=5)
    expected = {"title": "Eel", "credit": "Ada", "licence": "CC0-1.0", "listed": False}
    assert document == {"creature": SHA, **expected}
    client.share(served.run(record), generation=3, listed=True)
    expected = {"run": record["id"], "generation": 3, "listed": True}
    assert served.requests[-1].document == expected
    assert [one.slug for one in (*client.shares(), *client.commons())] == ["s1", "s1"]
    client.unshare("http://fake/s/s1")
    assert sent(served) == ("DELETE", "shares/s1", None)
    found.revoke()
    assert sent(served) == ("DELETE", "shares/s1", None)


def test_tokens_are_made_listed_and_revoked(fake):
    token = {"id": "70ce0000-0000-4000-8000-000000000001", "name": "laptop"}
    answers = {
        ("POST", "tokens"): token | {"secret": "once"},
        ("GET", "tokens"): [token],
        ("DELETE", f"tokens/{token['id']}"): httpx.Response(204),
    }
    served = fake(answers)
    assert served.client.create_token("laptop", "write")["secret"] == "once"
    assert sent(served) == ("POST", "tokens", {"name": "laptop", "scope": "write"})
    assert served.client.tokens() == [token]
    served.client.revoke_token("70ce")
    assert sent(served) == ("DELETE", f"tokens/{token['id']}", None)


def test_the_token_goes_with_every_request():
    sent = []

    def answer(request: httpx.Request) -> httpx.Response:
        sent.append(request.headers["authorization"])
        return httpx.Response(200, json=[])

    Client("http://fake", "secret", transport=httpx.MockTransport(answer)).workers()
    assert sent == ["Bearer secret"]


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
    assert creature.save(tmp_path / "one.gif").read_bytes() == b"GIF89a"
    with pytest.raises(ValueError, match=r"got one\.bmp"):
        creature.save(tmp_path / "one.bmp")
