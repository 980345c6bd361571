"""Creatures side by side: chosen in an archive, compared, and saved as picture and film."""

from pages import TOUR_TAKEN, see_it_move
from playwright.sync_api import expect

SAVED = {
    "Picture (PNG)": (b"\x89PNG",),
    "GIF": (b"GIF89a",),
    "Film": (b"\x00\x00\x00", bytes.fromhex("1a45dfa3")),
}
"""Buttons, and how the files begin that they save."""


def test_three_creatures_of_an_archive_swim_side_by_side_and_are_saved(page, shared):
    run = shared.finished("search")
    archive = shared.product.get(f"runs/{run}/archive")
    page.add_init_script(TOUR_TAKEN)
    cells = ",".join(map(str, archive["cell"][:3]))
    page.goto(f"{shared.product.url}/runs/{run}?cells={cells}")
    page.get_by_role("link", name="Side by side").click()
    race = page.get_by_role("img", name="3 creatures that swim to the right, in lanes")
    expect(race).to_be_visible()
    see_it_move(race)
    for creature in archive["creature"][:3]:
        link = page.get_by_role("link", name=creature[:8])
        expect(link).to_have_attribute("href", f"/creatures/{creature}")
    table = page.get_by_role("region", name="Facts of the creatures")
    expect(table.get_by_role("rowheader", name="Fitness")).to_be_visible()
    expect(table.get_by_role("rowheader", name="World")).to_have_count(0)  # It is the same.
    page.get_by_label("Pace").select_option("4 ×")
    for name, beginnings in SAVED.items():
        with page.expect_download() as download:
            page.get_by_role("button", name=name, exact=True).click()
        data = download.value.path().read_bytes()
        assert data.startswith(beginnings), name
        assert len(data) > 2_000, name
