"""A creature and an archive are published, viewed by others, and revoked."""

import re
from collections.abc import Callable
from urllib.parse import urlsplit

from drive import wait_until
from pages import best_of, stage
from playwright.sync_api import Page, Request, Route, expect

SLOW = 300_000


def test_a_creature_is_published_viewed_and_revoked(shared, page, anonymous_page):
    address = shared.product.url
    sha = best_of(shared.product, shared.finished("voronoi"))
    page.route(f"**/api/v1/creatures/{sha}", with_licence("CC-BY-NC-4.0"))
    page.goto(f"{address}/creatures/{sha}")
    link = publish(page, "An eel <b>&", listed=True)
    asked = requests_of(anonymous_page)
    anonymous_page.goto(link)
    expect(anonymous_page.get_by_role("heading", level=1)).to_contain_text("An eel <b>&")
    expect(stage(anonymous_page)).to_be_visible(timeout=SLOW)
    expect(anonymous_page.get_by_text("Ada, Bob").first).to_be_visible()
    expect(anonymous_page.get_by_role("button", name="Publish")).to_have_count(0)
    check_requests(link, asked)
    check_the_link_preview(anonymous_page, link)
    find_it_in_the_commons(anonymous_page, address, link)
    revoke(page, address, "An eel <b>&")
    anonymous_page.goto(link)
    expect(anonymous_page.get_by_text("Its owner has revoked this share.")).to_be_visible()


def with_licence(licence: str) -> Callable[[Route], None]:
    """Have the file of a creature name a licence."""

    def answer(route: Route) -> None:
        file = route.fetch()
        route.fulfill(response=file, json=file.json() | {"licence": licence})

    return answer


def publish(page: Page, title: str, *, listed: bool) -> str:
    """Publish by the dialog, and return the link."""
    page.get_by_role("button", name="Publish").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_label("Title").fill(title)
    dialog.get_by_label("Credit").fill("Ada, Bob")
    licence = dialog.get_by_label("Licence")
    expect(licence).to_have_value("CC-BY-NC-4.0")  # That of the file.
    licence.select_option("CC-BY-SA-4.0")
    dialog.get_by_label("Expires").select_option("7")
    if listed:
        dialog.get_by_label("List in the commons").check()
    dialog.get_by_role("button", name="Publish").click()
    found = dialog.get_by_label("Link")
    expect(found).to_be_visible()
    return found.input_value()


def requests_of(page: Page) -> list[tuple[str, str | None]]:
    """Requests of a page from now on, as path and share."""
    asked: list[tuple[str, str | None]] = []

    def note(request: Request) -> None:
        path = urlsplit(request.url).path
        asked.append((path, request.headers.get("microcosmos-share")))

    page.on("request", note)
    return asked


def check_requests(link: str, asked: list[tuple[str, str | None]]) -> None:
    """The page of a share asks for its own script, and for data through the share alone."""
    slug = link.rpartition("/")[2]
    own = re.compile(rf"/s/{slug}(/.*)?|/assets/.+|/favicon.svg|/api/v1/shares/{slug}(/.*)?")
    assert asked, "it was listened to"
    others = [path for path, share in asked if share != slug and not own.fullmatch(path)]
    assert others == []


def check_the_link_preview(anonymous_page: Page, link: str) -> None:
    """Other sites find a title, and a picture that exists."""
    text = anonymous_page.request.get(link).text()
    assert 'property="og:title" content="An eel &lt;b&gt;&amp;"' in text
    found = re.search('property="og:image" content="([^"]+)"', text)
    assert found

    def drawn():
        answer = anonymous_page.request.get(found[1])
        return answer.body() if answer.status == 200 else None

    picture = wait_until(drawn, SLOW / 1000, "the picture is drawn", every=0.5)
    assert picture.startswith(b"\x89PNG")


def find_it_in_the_commons(anonymous_page: Page, address: str, link: str) -> None:
    asked = requests_of(anonymous_page)
    anonymous_page.goto(f"{address}/commons")
    tile = anonymous_page.get_by_role("link", name=re.compile("An eel <b>&"))
    expect(tile).to_have_attribute("href", urlsplit(link).path)
    public = re.compile("/commons|/assets/.+|/favicon.svg|/api/v1/(commons|shares/.+)")
    moves = re.compile("/api/v1/creatures/[0-9a-f]{64}/poses")
    through = {path for path, share in asked if share and moves.fullmatch(path)}
    assert [
        path for path, _ in asked if path not in through and not public.fullmatch(path)
    ] == []


def revoke(page: Page, address: str, title: str) -> None:
    page.goto(f"{address}/shares")
    page.get_by_role("button", name=f"Revoke {title}").click()
    page.get_by_role("button", name=f"Revoke now: {title}").click()
    expect(page.get_by_text(f"{title} is no longer shared.")).to_be_visible()
