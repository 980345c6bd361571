"""The page of a share: previews for other sites, and escaped names."""

import re

import httpx
import pytest

from microcosmos_server.core import static_files
from microcosmos_server.tables import LOOP, PREVIEW

INDEX = "<!doctype html><html><head><title>Microcosmos</title>\n</head><body></body></html>"
HOSTILE = """</title><script>alert("x")</script>'&"""


@pytest.fixture
def built(tmp_path, monkeypatch):
    (tmp_path / "dist").mkdir()
    (tmp_path / "dist" / "index.html").write_text(INDEX)
    monkeypatch.setattr(static_files, "BUILT", tmp_path / "dist")


def test_the_page_of_a_share_has_previews_for_other_sites(api, address, built, known):
    sent = {"creature": known, "title": HOSTILE, "credit": [HOSTILE]}
    slug = api.post("shares", json=sent).json()["slug"]
    answer = api.get(f"{address}/s/{slug}")
    assert answer.status_code == 200
    tags = dict(
        re.findall(r'<meta (?:property|name)="([\w:]+)" content="([^"]*)" />', answer.text)
    )
    assert tags["og:image"] == f"{address}/api/v1/shares/{slug}/preview.png"
    assert (tags["og:image:width"], tags["og:image:height"]) == ("1200", "630")
    assert tags["twitter:card"] == "summary_large_image"
    assert f'<link rel="canonical" href="{address}/s/{slug}" />' in answer.text
    escaped = "&lt;/title&gt;&lt;script&gt;alert(&quot;x&quot;)&lt;/script&gt;&#x27;&amp;"
    assert tags["og:title"] == escaped
    assert escaped in tags["og:description"]
    assert f"<title>{escaped} · Microcosmos</title>" in answer.text
    assert "<script>" not in answer.text
    for name in ("x-robots-tag", "referrer-policy"):
        assert name in answer.headers


def test_a_lost_preview_is_ordered_again_by_its_next_visitor(
    api, address, built, services, known
):
    slug = api.post("shares", json={"creature": known}).json()["slug"]
    services.jobs.renderings.empty()
    assert api.get(f"{address}/s/{slug}").status_code == 200
    jobs = services.jobs.renderings.get_jobs()
    assert [job.args for job in jobs] == [[known, PREVIEW], [known, LOOP]]


def test_the_address_outside_is_what_the_settings_say(served, address, built, known):
    asked = {"X-Forwarded-Host": "evil.example", "X-Forwarded-Proto": "https"}
    there = served(public_url="https://swim.example/")
    with httpx.Client(base_url=there) as client:
        share = client.post("/api/v1/shares", json={"creature": known}).json()
        assert share["url"] == f"https://swim.example/s/{share['slug']}"
        text = client.get(f"/s/{share['slug']}", headers=asked).text
        assert f"https://swim.example/api/v1/shares/{share['slug']}/preview.png" in text
    assert "evil.example" not in httpx.get(f"{address}/s/{share['slug']}", headers=asked).text


def test_other_sites_may_frame_the_embedded_page_alone(api, address, built, known):
    slug = api.post("shares", json={"creature": known}).json()["slug"]
    for path, ancestors in (
        (f"s/{slug}/embed", "*"),
        (f"s/{slug}", "'none'"),
        (f"s/{slug}/embed/x", "'none'"),
        ("s/none/embed", "*"),  # It explains itself in a frame too.
        ("embed", "'none'"),
    ):
        policy = api.get(f"{address}/{path}").headers["content-security-policy"]
        assert policy.split("; ")[-1] == f"frame-ancestors {ancestors}", path


def test_the_page_of_a_revoked_share_shows_nothing(api, address, built, known):
    slug = api.post("shares", json={"creature": known}).json()["slug"]
    api.delete(f"shares/{slug}")
    framed = api.get(f"{address}/s/{slug}/embed")
    assert framed.status_code == 410
    assert framed.headers["content-security-policy"].endswith("frame-ancestors *")
    gone = api.get(f"{address}/s/{slug}")
    assert (gone.status_code, "og:title" in gone.text) == (410, False)
    assert api.get(f"{address}/s/none/creatures/x").status_code == 404


@pytest.mark.parametrize("name", ["%00", "a" * 10_000, "%ED%A0%80", "%0A"])
def test_impossible_slugs_are_not_found(api, address, built, name):
    """Databases do not take every text; the answer is that of an unknown slug."""
    for path in (f"{address}/s/{name}", f"{address}/s/{name}/creatures/x", f"shares/{name}"):
        assert api.get(path).status_code in (404, 422), path
    assert api.delete(f"shares/{name}").status_code in (404, 422)
    assert api.get(f"commons?cursor={name}").status_code == 422
    assert api.get(f"shares?cursor={name}").status_code == 422
