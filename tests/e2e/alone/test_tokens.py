"""A server that asks for tokens: its first one, others, and what happens when they end."""

import re
import stat
from collections.abc import Iterator
from pathlib import Path

import pytest
from drive import Installation, running
from looks import faults, violations
from playwright.sync_api import Browser, Page, expect
from small import TINY

SECRET = re.compile(r"mc_[\w-]{43}")


@pytest.fixture
def guarded(chromium: str, common: dict[str, str], tmp_path: Path) -> Iterator[Installation]:
    """A product without workers that needs a token even from this machine."""
    needed = {"MICROCOSMOS_AUTH": "required", "WORKERS": "0"}
    with running(tmp_path / "data", common | needed) as place:
        yield place


@pytest.mark.e2e
def test_an_admin_signs_in_and_manages_tokens(
    guarded: Installation, browser: Browser, stranger: Page
):
    alice, first = stranger, told_at_the_start(guarded)
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    admin = context.new_page()
    try:
        sign_in(admin, guarded.url, first)
        secret = make_a_token(admin, guarded.url)
        use_it(alice, guarded.url, secret)
        stay_within_what_it_may(alice, guarded, first)
        revoke_it(admin)
        # The stream that she watches ends, and the page finds out why.
        expect(alice.get_by_role("heading", name="Sign in")).to_be_visible(timeout=20_000)
        admin.get_by_role("button", name="Sign out").click()
        expect(admin.get_by_role("heading", name="Sign in")).to_be_visible()
    finally:
        context.close()


def told_at_the_start(place: Installation) -> str:
    """The token, printed once and kept in a private file."""
    (told,) = SECRET.findall(place.output.read_text())
    file = place.folder / "admin-token"
    assert file.read_text().strip() == told
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert told not in (place.folder / "logs" / "server.log").read_text()
    return told


def sign_in(page: Page, address: str, secret: str) -> None:
    page.goto(address)
    field = page.get_by_label("Token")
    expect(field).to_be_visible()
    assert violations(page) == []
    field.fill("mc_wrong")
    page.keyboard.press("Enter")
    expect(page.get_by_role("alert")).to_contain_text("does not know the token")
    field.fill(secret)
    page.keyboard.press("Enter")
    expect(page.get_by_role("heading", name="Sign in")).to_be_hidden()
    expect(page.get_by_role("status").filter(has_text="Live")).to_be_visible()


def make_a_token(page: Page, address: str) -> str:
    page.get_by_role("link", name="Settings").click()
    expect(page.get_by_role("heading", name="admin")).to_be_visible()
    page.get_by_label("Owner").fill("alice")
    page.keyboard.press("Enter")
    shown = page.locator(".secret code")
    expect(shown).to_be_visible()
    secret = shown.inner_text()
    assert SECRET.fullmatch(secret)
    expect(page.get_by_role("row", name=re.compile("^alice"))).to_contain_text(secret[:9])
    assert violations(page) == []
    desk = page.viewport_size
    page.set_viewport_size({"width": 390, "height": 844})
    assert faults(page) == []
    assert desk
    page.set_viewport_size(desk)
    page.reload()
    expect(page.get_by_role("row", name=re.compile("^alice"))).to_be_visible()
    assert secret not in page.content()
    return secret


def use_it(page: Page, address: str, secret: str) -> None:
    """Other principals see their name, but no tokens."""
    sign_in(page, address, secret)
    page.goto(f"{address}/settings")
    expect(page.get_by_role("heading", name="alice")).to_be_visible()
    expect(page.get_by_role("heading", name="Tokens")).to_be_hidden()
    page.goto(address)


def stay_within_what_it_may(page: Page, place: Installation, first: str) -> None:
    """Another's run names its owner and has no buttons; one's own has them."""
    as_admin = {"Authorization": f"Bearer {first}"}
    asked = place.http.post("/api/v1/runs", json=TINY, headers=as_admin).raise_for_status()
    theirs = asked.json()["id"]
    row = page.get_by_role("row", name=re.compile(theirs[:8]))
    expect(row.get_by_role("link", name=re.compile("^Clone"))).to_be_visible()
    expect(row.get_by_role("button")).to_have_count(0)
    page.goto(f"{place.url}/runs/{theirs}")
    expect(page.get_by_text("Only admin or an admin can change it.")).to_be_visible()
    expect(page.get_by_role("button", name=re.compile("^(Cancel|Pause|Rename)"))).to_have_count(
        0
    )
    own = page.request.post(f"{place.url}/api/v1/runs", data={**TINY, "seed": 1})
    page.goto(f"{place.url}/runs/{own.json()['id']}")
    expect(page.get_by_role("button", name=re.compile("^Cancel"))).to_be_visible()
    page.goto(place.url)


def revoke_it(page: Page) -> None:
    page.get_by_role("button", name="Revoke alice").click()
    page.get_by_role("button", name="Revoke now: alice").click()
    expect(page.get_by_role("row", name=re.compile("^alice"))).to_contain_text("Revoked")
