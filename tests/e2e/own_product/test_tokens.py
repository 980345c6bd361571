"""A server that requires tokens: the first one, further ones, and their revocation."""

import re
import stat

import pytest
from drive import Installation, running
from layout import violations
from playwright.sync_api import Page, expect
from small_runs import TINY

SECRET = re.compile(r"mc_[\w-]{43}")


@pytest.fixture
def protected_product(product_settings, tmp_path):
    """A product without workers that needs a token even from this machine."""
    needed = {"MICROCOSMOS_AUTH": "required", "WORKERS": "0"}
    with running(tmp_path / "data", product_settings | needed) as product:
        yield product


def test_an_admin_signs_in_and_manages_tokens(protected_product, new_page):
    alice, admin, first = new_page(), new_page(), first_token(protected_product)
    sign_in(admin, protected_product.url, first)
    secret = make_a_token(admin)
    use_it(alice, protected_product.url, secret)
    see_anothers_run(alice, protected_product, first)
    revoke_it(admin)
    # The event stream of the page ends, and the page asks for a token.
    expect(alice.get_by_role("heading", name="Sign in")).to_be_visible()
    admin.get_by_role("button", name="Sign out").click()
    expect(admin.get_by_role("heading", name="Sign in")).to_be_visible()


def first_token(product: Installation) -> str:
    """The token, printed once and kept in a private file."""
    (secret,) = SECRET.findall(product.output.read_text())
    file = product.folder / "admin-token"
    assert file.read_text().strip() == secret
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert secret not in (product.folder / "logs" / "server.log").read_text()
    return secret


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


def make_a_token(page: Page) -> str:
    page.get_by_role("link", name="Settings").click()
    expect(page.get_by_role("heading", name="admin")).to_be_visible()
    page.get_by_label("Owner").fill("alice")
    page.get_by_role("combobox", name="Scope").select_option("Read and write")
    page.get_by_label("Owner").focus()
    page.keyboard.press("Enter")
    shown = page.locator(".secret code")
    expect(shown).to_be_visible()
    secret = shown.inner_text()
    assert SECRET.fullmatch(secret)
    expect(page.get_by_role("row", name=re.compile("^alice"))).to_contain_text(secret[:9])
    assert violations(page) == []
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


def see_anothers_run(page: Page, product: Installation, first: str) -> None:
    as_admin = {"Authorization": f"Bearer {first}"}
    asked = product.http.post("/api/v1/runs", json=TINY, headers=as_admin).raise_for_status()
    page.goto(f"{product.url}/runs/{asked.json()['id']}")
    expect(page.get_by_text("Only admin or an admin can change it.")).to_be_visible()
    buttons = page.get_by_role("button", name=re.compile("^(Cancel|Pause|Rename)"))
    expect(buttons).to_have_count(0)


def revoke_it(page: Page) -> None:
    page.get_by_role("button", name="Revoke alice").click()
    page.get_by_role("button", name="Revoke now: alice").click()
    expect(page.get_by_role("row", name=re.compile("^alice"))).to_contain_text("Revoked")
