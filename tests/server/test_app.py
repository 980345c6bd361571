"""The application: health, page, OpenAPI document, and no import of JAX."""

import subprocess
import sys
import time

import httpx
import pytest

from microcosmos_server.core import static_files


def test_a_server_is_ready_with_redis_and_alive_without(address, served):
    assert httpx.get(f"{address}/healthz").json()["status"] == "ok"
    ready = httpx.get(f"{address}/readyz")
    assert (ready.status_code, ready.json()) == (
        200,
        {"database": "ok", "redis": "ok", "store": "ok", "disk": "ok"},
    )
    alone = served(redis_url="redis://127.0.0.1:1/0")
    assert httpx.get(f"{alone}/healthz").status_code == 200
    ready = httpx.get(f"{alone}/readyz", timeout=20)
    assert (ready.status_code, ready.json()["redis"]) == (503, "unreachable")


@pytest.fixture
def built(tmp_path, monkeypatch):
    folder = tmp_path / "dist"
    (folder / "assets").mkdir(parents=True)
    (folder / "index.html").write_text("<title>the page</title>")
    (folder / "assets" / "a1b2.js").write_text("script")
    (tmp_path / "secret").write_text("secret")
    monkeypatch.setattr(static_files, "BUILT", folder)


def test_paths_outside_the_api_are_the_page_and_impossible_ones_missing(built, address):
    for path in ("/", "/runs/1", "/creatures/ab?view=network", "/%2e%2e/secret"):
        answer = httpx.get(f"{address}{path}")
        assert answer.text == "<title>the page</title>", path
        assert answer.headers["cache-control"] == "no-cache", path
    for path in ("/%00", "/" + "a" * 300, "/assets/%00"):
        assert httpx.get(f"{address}{path}").status_code == 404, path


def test_assets_are_compressed_on_request_and_cached_for_ever(built, address):
    for accepted, encoding in (("gzip", "gzip"), ("identity", None)):
        headers = {"Accept-Encoding": accepted}
        answer = httpx.get(f"{address}/assets/a1b2.js", headers=headers)
        assert (answer.text, answer.headers.get("content-encoding")) == ("script", encoding)
        assert answer.headers["content-type"].startswith("text/javascript")
        assert "immutable" in answer.headers["cache-control"]
    assert httpx.get(f"{address}/assets/gone.js").status_code == 404


def test_the_documentation_is_served_and_announced_where_it_was_built(
    address, tmp_path, monkeypatch
):
    monkeypatch.setattr(static_files, "DOCUMENTATION", tmp_path / "site")
    assert httpx.get(f"{address}/healthz").json()["help"] is False
    assert "make docs" in httpx.get(f"{address}/help/").json()["detail"]
    (tmp_path / "site").mkdir()
    (tmp_path / "secret").write_text("secret")
    (tmp_path / "site" / "index.html").write_text("<title>the documentation</title>")
    assert httpx.get(f"{address}/healthz").json()["help"] is True
    answer = httpx.get(f"{address}/help", follow_redirects=True)
    assert (answer.url.path, answer.text) == ("/help/", "<title>the documentation</title>")
    assert httpx.get(f"{address}/help/%2e%2e/secret").status_code == 404


def test_a_missing_page_says_how_to_build_it(address, tmp_path, monkeypatch):
    monkeypatch.setattr(static_files, "BUILT", tmp_path / "nowhere")
    answer = httpx.get(f"{address}/")
    assert answer.status_code == 503
    assert "<code>make</code>" in answer.text


def test_the_server_loads_no_jax():
    modules = "microcosmos_server.app, microcosmos_server.maintenance.healthcheck"
    code = f"import {modules}, sys; print(any(m.split('.')[0] == 'jax' for m in sys.modules))"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert found.stdout.strip() == "False", found.stderr


def test_sigterm_ends_a_server_with_open_streams_at_once(start_server):
    with (
        start_server() as (process, address),
        httpx.stream("GET", f"{address}/api/v1/events") as stream,
    ):
        lines = stream.iter_lines()
        next(lines)
        begun = time.monotonic()
        process.terminate()
        list(lines)
        process.wait()
    assert time.monotonic() - begun < 4, "uvicorn alone would wait for 5 s"
