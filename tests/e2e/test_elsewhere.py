"""Shares live elsewhere: imported by pasting, saved as one file, embedded in another page."""

import re
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread

import httpx
import pytest
from browser import collect_complaints
from pages import best_of, stage
from playwright.sync_api import expect

SLOW = 300_000


@pytest.fixture(scope="module")
def share(shared):
    address = f"{shared.product.url}/api/v1/shares"
    sha = best_of(shared.product, shared.finished("voronoi"))
    sent = {"creature": sha, "title": "An eel </script>", "credit": ["Ada"]}
    return httpx.post(address, json=sent).raise_for_status().json()


def test_a_share_is_imported_by_pasting_its_address(shared, share, page):
    """The product has two names, which are two origins to a browser."""
    other = shared.product.url.replace("127.0.0.1", "localhost")
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.goto(other)
    page.evaluate("text => navigator.clipboard.writeText(text)", share["url"])
    page.get_by_role("heading", level=1).first.click()
    page.keyboard.press("Control+V")
    page.wait_for_url(re.compile(r"/import\?share="))
    expect(page.get_by_text("hash verified")).to_be_visible()
    expect(page.get_by_text("Ada")).to_be_visible()
    page.get_by_role("button", name="Import", exact=True).click()
    page.wait_for_url(f"{other}/creatures/{share['creature']}")


def test_all_creatures_of_an_archive_are_imported(shared, page):
    run = shared.finished("voronoi")
    address = f"{shared.product.url}/api/v1/shares"
    sent = {"run": run, "title": "Swimmers"}
    archive = httpx.post(address, json=sent).raise_for_status().json()
    names = httpx.get(f"{address}/{archive['slug']}/creatures.json").json()["creatures"]
    assert len(names) > 1
    other = shared.product.url.replace("127.0.0.1", "localhost")
    page.goto(f"{other}/import?share={archive['url']}")
    page.get_by_role("button", name="Import all", exact=True).click()
    expect(page.get_by_text(f"Imported all {len(names)} creatures.")).to_be_visible()
    page.get_by_role("link", name=names[0][:8]).click()
    page.wait_for_url(f"{other}/creatures/{names[0]}")


def test_the_page_of_an_import_requests_one_file_of_another_site(shared, share, anonymous_page):
    other = shared.product.url.replace("127.0.0.1", "localhost")
    anonymous_page.goto(f"{other}/import?share={share['url']}")
    expect(anonymous_page.get_by_text("hash verified")).to_be_visible()
    for path in ("commons", f"shares/{share['slug']}"):
        blocked = anonymous_page.evaluate(
            """url => new Promise((done) => {
              addEventListener("securitypolicyviolation", (event) => done(event.blockedURI));
              fetch(url).catch(() => {});
            })""",
            f"{shared.product.url}/api/v1/{path}",
        )
        assert blocked.endswith(path)


def test_a_saved_page_plays_and_verifies_without_a_network(
    shared, share, anonymous_page, new_page, complaints, tmp_path
):
    anonymous_page.goto(share["url"])
    expect(stage(anonymous_page)).to_be_visible(timeout=SLOW)
    with anonymous_page.expect_download(timeout=SLOW) as event:
        anonymous_page.get_by_role("button", name="Web page").click()
    file = tmp_path / "creature.html"
    event.value.save_as(file)
    assert file.stat().st_size < 700_000
    saved, asked = new_page(), []
    collect_complaints(saved, complaints)
    saved.on("request", lambda request: asked.append(request.url))
    saved.context.set_offline(True)
    saved.goto(file.as_uri())
    expect(saved.get_by_role("heading", level=1)).to_have_text("An eel </script>")
    expect(saved.get_by_label("Time in the replay")).to_be_visible()
    saved.get_by_role("button", name="Verify").click()
    expect(
        saved.get_by_text(re.compile(r"numbers (equal|differ)|bit by bit\.$"))
    ).to_be_visible()
    saved.get_by_role("button", name="Swim on").click()
    expect(saved.locator(".live-water canvas")).to_be_visible()
    assert [url for url in asked if not url.startswith(("file:", "blob:null/"))] == []
    assert complaints == []


@pytest.fixture
def blog(share):
    """The address of another site with a share in a frame."""

    class Blog(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(f'<iframe src="{share["url"]}/embed"></iframe>'.encode())

        def log_message(self, *_: object) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Blog) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://localhost:{server.server_port}/"
        server.shutdown()


def test_a_share_plays_within_the_page_of_another_site(blog, share, anonymous_page):
    anonymous_page.goto(blog)
    frame = anonymous_page.frame_locator("iframe")
    expect(frame.get_by_label("Time in the replay")).to_be_visible(timeout=SLOW)
    link = frame.get_by_role("link", name=share["title"])
    expect(link).to_have_attribute("href", share["url"])


def test_the_tree_of_a_share_leads_back_to_its_creature(share, page):
    page.goto(share["url"])
    page.get_by_role("link", name="Tree of life").click()
    page.wait_for_url(f"{share['url']}/tree")
    window = page.get_by_role("application", name=re.compile("^Tree of life"))
    expect(window).to_have_attribute("aria-busy", "false")
    page.get_by_role("region", name="Creature", exact=True).get_by_role("link").first.click()
    page.wait_for_url(share["url"])
