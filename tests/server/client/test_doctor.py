"""What the doctor finds at an address."""

from datetime import UTC, datetime, timedelta

from pydantic import SecretStr

from microcosmos.doctor.server import server, workers


def levels(findings):
    return [finding.level for finding in findings]


def test_a_server_without_workers_is_told(address, services):
    found = list(server(address, None))
    subjects = {one.subject for one in found if one.level == "ok"}
    assert subjects == {"server", "database", "disk", "Redis"}
    assert found[0].found.endswith(f"answers at {address}")
    assert levels(found)[-1] == "warning"
    assert "WORKERS=n" in found[-1].advice


def test_a_server_that_lost_its_redis_is_told(serve, services):
    with serve(redis_url="redis://127.0.0.1:1/0") as address:
        found = list(server(address, None))
    assert "problem" in levels(found)
    assert any(one.subject == "Redis" and one.level == "problem" for one in found)


def test_a_token_is_asked_for(serve, monkeypatch):
    monkeypatch.delenv("MICROCOSMOS_TOKEN", raising=False)
    with serve(token=SecretStr("sesame")) as address:
        assert levels(server(address, None)) == ["problem"]
        assert "problem" not in levels(server(address, "sesame"))


def test_another_version_is_a_warning(address, monkeypatch):
    monkeypatch.setattr("microcosmos.doctor.server.VERSION", "9.9.9")
    first = next(server(address, None))
    assert first.level == "warning"
    assert "this is 9.9.9" in first.found


def test_a_worker_that_is_silent_is_told():
    now = datetime(2026, 1, 1, tzinfo=UTC)
    one = {"name": "here-1", "device": "cpu", "status": "busy"}
    beats = [now - timedelta(seconds=age) for age in (3, 60)]
    found = workers([one | {"heartbeat_at": beat.isoformat()} for beat in beats], now)
    assert [(each.level, each.found.split(", ")[-1]) for each in found] == [
        ("ok", "reported 3 s ago"),
        ("warning", "reported 60 s ago"),
    ]
