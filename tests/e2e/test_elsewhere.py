"""Shares live elsewhere: imported by pasting, saved as one file, embedded in another page."""

import re

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


def test_a_share_is_imported_by_pasting_its_address(shared, share, page, complaints):
    """The product has two names, which are two origins to a browser."""
    other = shared.product.url.replace("127.0.0.1", "localhost")
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.goto(other)
    page.evaluate("text => navigator.clipboard.writeText(text)", share["url"])
    page.get_by_role("heading", level=1).first.click()
    page.keyboard.press("Control+V")
    page.wait_for_url(re.compile(r"/import\?share="))
    expect(page.get_by_text("hash verified")).to_be_visible()
    blocked = page.evaluate(
        """url => new Promise((done) => {
          addEventListener("securitypolicyviolation", (event) => done(event.blockedURI));
          fetch(url).catch(() => {});
        })""",
        f"{shared.product.url}/api/v1/commons",
    )
    assert blocked.endswith("commons"), "one file of the other site is all that it may read"
    page.get_by_role("button", name="Import", exact=True).click()
    page.wait_for_url(f"{other}/creatures/{share['creature']}")
    complaints[:] = [text for text in complaints if "/api/v1/commons" not in text]


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
