"""A creature and an archive are published, viewed by others, and revoked."""

import re
from urllib.parse import urlsplit

from pages import TOUR_TAKEN, best_of, stage, the_map
from playwright.sync_api import Page, Request, expect

SLOW = 300_000
FIRST_S = 300


def test_a_creature_is_published_viewed_and_revoked(shared, page, anonymous_page):
    address = shared.product.url
    sha = best_of(shared.product, shared.finished("voronoi"))
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
    import_it(anonymous_page, address, sha)
    find_it_in_the_commons(anonymous_page, address, link)
    revoke(page, address, "An eel <b>&")
    anonymous_page.goto(link)
    expect(anonymous_page.get_by_text("Its owner has revoked this share.")).to_be_visible()


def test_an_archive_is_published_and_its_elites_are_opened(shared, page, anonymous_page):
    address = shared.product.url
    page.add_init_script(TOUR_TAKEN)
    anonymous_page.add_init_script(TOUR_TAKEN)
    page.goto(f"{address}/runs/{shared.finished('voronoi')}")
    link = publish(page, "Eels", listed=False)
    asked = requests_of(anonymous_page)
    anonymous_page.goto(link)
    the_map(anonymous_page).focus()
    anonymous_page.keyboard.press("ArrowRight")
    anonymous_page.keyboard.press("Enter")
    anonymous_page.wait_for_url(re.compile("/s/.+/creatures/"))
    expect(stage(anonymous_page)).to_be_visible(timeout=SLOW)
    check_requests(link, asked)
    slug = link.rpartition("/")[2]
    commons = anonymous_page.request.get(f"{address}/api/v1/commons").json()["items"]
    assert slug not in [share["slug"] for share in commons], "it is not listed"


def publish(page: Page, title: str, *, listed: bool) -> str:
    """Publish by the dialog, and return the link."""
    page.get_by_role("button", name="Publish").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_label("Title").fill(title)
    dialog.get_by_label("Credit").fill("Ada, Bob")
    dialog.get_by_label("Licence").select_option("CC-BY-SA-4.0")
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
    picture = anonymous_page.request.get(found[1])
    for _ in range(FIRST_S):
        if picture.status == 200:
            break
        anonymous_page.wait_for_timeout(1000)
        picture = anonymous_page.request.get(found[1])
    assert picture.headers["content-type"] == "image/png"
    width, height = (int.from_bytes(picture.body()[at : at + 4]) for at in (16, 20))
    assert (width, height) == (1200, 630)


def import_it(anonymous_page: Page, address: str, sha: str) -> None:
    """An imported download keeps name, licence and credit."""
    with anonymous_page.expect_download() as event:
        anonymous_page.get_by_role("link", name="JSON").click()
    text = event.value.path().read_text()
    for word in ('"CC-BY-SA-4.0"', '"Ada"', '"ancestors"'):
        assert word in text
    answer = anonymous_page.request.post(
        f"{address}/api/v1/creatures", data=text, headers={"Content-Type": "application/json"}
    )
    assert (answer.status, answer.json()) == (200, {"creature": sha})


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
    expect(page.get_by_role("button", name=f"Revoke now: {title}")).to_be_focused()
    page.keyboard.press("Escape")
    expect(page.get_by_role("button", name=f"Revoke {title}")).to_be_focused()
    page.keyboard.press("Enter")
    page.get_by_role("button", name=f"Revoke now: {title}").click()
    expect(page.get_by_text(f"{title} is no longer shared.")).to_be_visible()
