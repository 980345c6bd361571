"""Creatures side by side: chosen in an archive, compared, and saved as picture and film."""

import re
from io import BytesIO

import pytest
from pages import TOUR_TAKEN, see_it_move
from PIL import Image
from playwright.sync_api import expect


@pytest.fixture
def three(shared):
    """The address of a run with three selected elites, and their creatures."""
    run = shared.finished("search")
    archive = shared.product.get(f"runs/{run}/archive")
    cells = ",".join(map(str, archive["cell"][:3]))
    return f"{shared.product.url}/runs/{run}?cells={cells}", archive["creature"][:3]


def test_three_creatures_of_an_archive_swim_side_by_side(page, three):
    address, creatures = three
    page.add_init_script(TOUR_TAKEN)
    page.goto(address)
    page.get_by_role("link", name="Side by side").click()
    race = page.get_by_role("img", name="3 creatures that swim to the right, in lanes")
    expect(race).to_be_visible()
    see_it_move(race)
    for creature in creatures:
        link = page.get_by_role("link", name=creature[:8])
        expect(link).to_have_attribute("href", f"/creatures/{creature}")
    table = page.get_by_role("region", name="Facts of the creatures")
    expect(table.get_by_role("rowheader", name="Fitness")).to_be_visible()
    expect(table.get_by_role("rowheader", name="World")).to_have_count(0)  # It is the same.
    page.get_by_role("button", name="Show all").click()
    expect(table.get_by_role("rowheader", name="World")).to_be_visible()
    own = table.get_by_role("row", name=re.compile("^Connections shared with the first"))
    expect(own.get_by_role("cell").first).to_have_text(re.compile(r"^(\d+) of \1$"))


def test_creatures_are_added_and_removed(page, three, shared):
    _, (first, second, _) = three
    page.goto(f"{shared.product.url}/compare?creatures={first}")
    page.get_by_role("textbox", name="Name or address of a creature").fill(
        f"{shared.product.url}/creatures/{second}?run=1"
    )
    page.get_by_role("button", name="Add", exact=True).click()
    page.wait_for_url(f"**/compare?creatures={first}%2C{second}")
    page.get_by_role("button", name=re.compile("^Add [0-9a-f]{8}, fitness")).first.click()
    expect(page.get_by_role("button", name=re.compile("^Remove "))).to_have_count(3)
    page.get_by_role("button", name=f"Remove {first[:8]}").click()
    expect(page.get_by_role("button", name=re.compile("^Remove "))).to_have_count(2)


def test_the_comparison_is_saved_as_a_picture_and_as_a_film(page, three, shared, tmp_path):
    _, creatures = three
    page.goto(f"{shared.product.url}/compare?creatures={','.join(creatures)}")
    race = page.get_by_role("img", name="3 creatures that swim to the right, in lanes")
    expect(race).to_be_visible()
    page.get_by_label("Pace").select_option("4 ×")
    with page.expect_download() as download:
        page.get_by_role("button", name="Picture (PNG)").click()
    saved = Image.open(BytesIO(download.value.path().read_bytes()))
    size = race.evaluate("({ width, height }) => [width, height]")
    assert list(saved.size) == size
    with page.expect_download() as download:
        page.get_by_role("button", name="GIF", exact=True).click()
    gif = Image.open(BytesIO(download.value.path().read_bytes()))
    assert gif.format == "GIF"
    assert gif.n_frames > 5
    with page.expect_download() as download:
        page.get_by_role("button", name="Film", exact=True).click()
    film = download.value.path().read_bytes()
    assert download.value.suggested_filename in ("creatures.mp4", "creatures.webm")
    assert b"ftyp" in film[:12] or film.startswith(bytes.fromhex("1a45dfa3"))
    assert len(film) > 20_000
