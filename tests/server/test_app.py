"""The application: health, page, OpenAPI document, and no import of JAX."""

import os
import socket
import subprocess
import sys
import time

import httpx
import pytest

from server.core import static_files


def test_a_server_is_ready_with_redis_and_alive_without(address, serve):
    assert httpx.get(f"{address}/healthz").json()["status"] == "ok"
    ready = httpx.get(f"{address}/readyz")
    assert (ready.status_code, ready.json()) == (
        200,
        {"database": "ok", "redis": "ok", "store": "ok", "disk": "ok"},
    )
    with serve(redis_url="redis://127.0.0.1:1/0") as alone:
        assert httpx.get(f"{alone}/healthz").status_code == 200
        ready = httpx.get(f"{alone}/readyz", timeout=20)
    assert (ready.status_code, ready.json()["redis"]) == (503, "unreachable")


def test_the_api_describes_itself(api):
    description = api.get("openapi.json").json()
    assert description["openapi"].startswith("3.1")
    paths = description["paths"]
    assert "/api/v1/runs/{run_id}/archive.h5" in paths
    assert "/healthz" in paths
    for path in ("runs", "runs/{run_id}/archive.h5", "creatures/{sha}/replay"):
        operation = next(iter(paths[f"/api/v1/{path}"].values()))
        (media,) = operation["responses"]["default"]["content"]
        assert media == "application/problem+json"
    for path in ("runs", "sweeps", "runs/{run_id}/fork"):
        answers = paths[f"/api/v1/{path}"]["post"]["responses"]
        assert {"200", "202"} <= answers.keys(), "a repeated key is answered by 200"
    assert "HTTPValidationError" not in description["components"]["schemas"]


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
    scripts = "script-src 'self' 'wasm-unsafe-eval';"
    assert scripts in answer.headers["content-security-policy"], "no inline scripts"
    assert "default-src 'self'" in answer.headers["content-security-policy"]
    for path in ("gone.html", "%2e%2e/secret"):
        assert httpx.get(f"{address}/help/{path}").status_code == 404


def test_a_missing_page_says_how_to_build_it(address, tmp_path, monkeypatch):
    monkeypatch.setattr(static_files, "BUILT", tmp_path / "nowhere")
    answer = httpx.get(f"{address}/")
    assert answer.status_code == 503
    assert "<code>make</code>" in answer.text


def test_the_server_loads_no_jax():
    modules = "server.app, server.maintenance.healthcheck"
    code = f"import {modules}, sys; print(any(m.split('.')[0] == 'jax' for m in sys.modules))"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert found.stdout.strip() == "False", found.stderr


def test_sigterm_ends_a_server_with_open_streams_at_once(services, tmp_path, eventually):
    settings = services.settings
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    environment = {
        **os.environ,
        "PORT": str(port),
        "MICROCOSMOS_DATA": str(tmp_path),
        "MICROCOSMOS_DATABASE_URL": settings.database_url,
        "MICROCOSMOS_REDIS_URL": settings.redis_url,
        "MICROCOSMOS_REDIS_PREFIX": settings.redis_prefix,
    }
    address = f"http://127.0.0.1:{port}"
    with subprocess.Popen([sys.executable, "-m", "server.main"], env=environment) as process:
        try:
            eventually(lambda: answers(f"{address}/healthz"))
            with httpx.stream("GET", f"{address}/api/v1/events") as stream:
                lines = stream.iter_lines()
                next(lines)
                begun = time.monotonic()
                process.terminate()
                list(lines)
            process.wait()
        finally:
            process.kill()  # In case it never answered.
    assert time.monotonic() - begun < 4, "uvicorn alone would wait for 5 s"


def answers(url: str) -> bool:
    try:
        return httpx.get(url).status_code == 200
    except httpx.ConnectError:
        return False
