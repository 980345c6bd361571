"""The archive of a run: map, time, gallery, tour."""

import re

import pytest
from pages import TOUR_TAKEN, best_of, elites, see_it_move, the_map
from playwright.sync_api import Page, Route, expect
from small_runs import CENTROIDS
from written_run import WrittenRun

SLOW = 120_000

FLASH_MS = 1200
WHERE_DRAWN_DIFFERENTLY = """before => {
  const canvas = document.querySelector(".map-plot canvas");
  const {width, height} = canvas;
  const copy = new OffscreenCanvas(width, height).getContext("2d");
  copy.drawImage(canvas, 0, 0);
  const {data} = copy.getImageData(0, 0, width, height);
  const drawn = Array.from(new Uint32Array(data.buffer));
  const apart = drawn.flatMap((pixel, k) => before && pixel !== before[k] ? [k] : []);
  return {drawn, apart: apart.map(k => [(k % width) / width, Math.floor(k / width) / height])};
}"""
"""The pixels of the map, and where it looks otherwise than before, as shares of its sides."""

TILES = """side => {
  const canvas = document.querySelector("[data-gallery] canvas");
  if (!canvas?.width) return [0, 0];
  const {width, height} = canvas;
  const copy = new OffscreenCanvas(width, height).getContext("2d");
  copy.drawImage(canvas, 0, 0);
  const {data} = copy.getImageData(0, 0, width, height);
  const drawn = new Uint32Array(data.buffer);
  const {clientWidth} = document.querySelector(".gallery-port > div");
  const tile = clientWidth / side;
  let filled = 0, bodies = 0;
  for (let top = 0; top + tile <= height; top += tile) {
    for (let left = 0; left + tile <= width; left += tile) {
      const at = (x, y) => drawn[Math.round(top + y) * width + Math.round(left + x)];
      const ground = at(4, 4);
      if (!(ground >>> 24)) continue;
      filled++;
      let ink = 0;
      for (let y = 5; y < tile - 8; y++)
        for (let x = 5; x < tile - 8; x++)
          ink += Math.hypot(x - tile / 2, y - tile / 2) > 6 && at(x, y) !== ground;
      bodies += ink > 10;
    }
  }
  return [filled, bodies];
}"""
"""Whole tiles with an elite, and those of them with more than a dot in the middle."""
ALL_BODIES = f"side => {{ const [a, b] = ({TILES})(side); return a > 0 && a === b; }}"

DRAWN = """selector => {
  const canvas = document.querySelector(selector);
  if (!canvas?.width) return 0;
  const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
  copy.drawImage(canvas, 0, 0);
  const {data} = copy.getImageData(0, 0, canvas.width, canvas.height);
  return data.filter(byte => byte > 0).length;
}"""
"""The number of bytes of a canvas that something is drawn on."""


@pytest.fixture
def searched(shared, page):
    """A finished search whose page is open, without the tour."""
    page.add_init_script(TOUR_TAKEN)
    run = shared.finished("search")
    page.goto(f"{shared.product.url}/runs/{run}")
    return run


@pytest.fixture
def size(shared, searched):
    """The number of elites of the finished search, now or after a generation."""
    return lambda **then: len(shared.product.get(f"runs/{searched}/archive", **then)["cell"])


def test_arrow_keys_walk_the_map_and_enter_opens_a_creature(shared, page, searched):
    the_map(page).focus()
    page.keyboard.press("ArrowRight")
    best = best_of(shared.product, searched)
    reading = page.locator("#elite-measures")
    expect(reading).to_contain_text(best[:8])
    page.keyboard.press("ArrowLeft")
    expect(reading).not_to_contain_text(best[:8])
    other = reading.locator("code").inner_text()
    page.keyboard.press("Enter")
    page.wait_for_url(re.compile(f"/creatures/{other}"))


def test_a_creature_swims_beside_the_pointer(page, searched):
    the_map(page).focus()
    page.keyboard.press("ArrowUp")
    canvas = page.locator("[data-inset] canvas")
    expect(canvas).to_be_visible(timeout=SLOW)
    see_it_move(canvas)


def test_bodies_are_fetched_again_whose_request_failed(shared, page, complaints):
    asked = []

    def fail_once(route: Route) -> None:
        asked.append(route.request.url)
        if len(asked) == 1:
            route.abort()
        else:
            route.continue_()

    page.route("**/archive/poses?*", fail_once)
    page.add_init_script(TOUR_TAKEN)
    run = shared.finished("search")
    with page.expect_response(lambda response: response.url in asked[:1]):
        page.goto(f"{shared.product.url}/runs/{run}")
    page.wait_for_function(f"() => ({DRAWN})('[data-bodies]') > 0")
    complaints[:] = [text for text in complaints if "net::ERR_FAILED" not in text]


def test_the_slider_shows_the_archive_of_every_generation(page, size):
    for generation in (1, 7, 20):
        page.get_by_role("slider", name="Generation shown").fill(str(generation))
        then = f"{size(generation=generation)} elites"
        expect(elites(page)).to_have_text(then)
    page.wait_for_url(re.compile("at=20"))
    page.reload()
    expect(elites(page)).to_have_text(then)
    page.get_by_role("button", name="Newest").click()
    expect(elites(page)).to_have_text(f"{size()} elites")


def test_the_history_plays_to_its_end(page, size):
    now = f"{size()} elites"
    expect(elites(page)).to_have_text(now)
    page.get_by_role("button", name="Play the history").click()
    expect(elites(page)).not_to_have_text(now)
    slider = page.get_by_role("slider", name="Generation shown")
    slider.fill("26")  # Close to the end, so the wait is short.
    page.get_by_role("button", name="Play the history").click()
    expect(page.get_by_role("button", name="Pause the history")).to_be_visible()
    expect(page.get_by_role("button", name="Play the history")).to_be_visible()
    expect(elites(page)).to_have_text(now)


def test_colours_and_axes_offer_every_recorded_measure(page, searched):
    page.get_by_label("Colour").select_option("age")
    expect(page.get_by_role("img", name=re.compile("^Age"))).to_be_visible()
    page.get_by_text("More", exact=True).click()
    page.get_by_label("Palette").select_option("cividis")
    page.get_by_role("combobox", name="Across", exact=True).select_option("path_length")
    page.wait_for_url(re.compile("x=path_length"))
    page.get_by_label("Symmetry, from").fill("8")
    page.wait_for_url(re.compile(r"only\.symmetry=8-"))
    assert re.search("colour=age.*palette=cividis", page.url)


def test_the_gallery_moves_and_is_walked_by_keys(page, searched):
    page.get_by_role("button", name="Gallery").click()
    page.wait_for_url(re.compile("view=gallery"))
    canvas = page.locator("[data-gallery] canvas")
    expect(canvas).to_be_visible()
    see_it_move(canvas)
    page.get_by_role("application", name="Gallery").focus()
    page.keyboard.press("ArrowDown")
    sha = page.locator("#elite-measures code").inner_text()
    page.keyboard.press("Enter")
    page.wait_for_url(re.compile(f"/creatures/{sha}"))


def test_every_tile_of_a_gallery_has_a_body_without_the_renderer(shared, page, searched):
    bins = shared.product.get(f"runs/{searched}/archive")["axes"][0]["bins"]
    expect(the_map(page)).to_be_visible()
    page.get_by_role("button", name="Gallery").click()
    page.wait_for_function(ALL_BODIES, arg=bins, timeout=SLOW)
    filled, bodies = page.evaluate(TILES, bins)
    assert filled == bodies > 10
    asked = page.evaluate("performance.getEntriesByType('resource').map((one) => one.name)")
    assert any("/archive/poses?" in url for url in asked), "by the map or by the gallery"
    assert [url for url in asked if "/creatures/" in url] == [], "which may render"


@pytest.mark.parametrize("motion", ["no-preference", "reduce"])
def test_a_cell_that_changes_live_flashes_once(page, idle, motion):
    """Only its outline flashes; nothing does where reduced motion is preferred."""
    run = WrittenRun(idle.services, seed=41)
    run.claim("worker 1")
    run.write_generations(1, 3)
    page.add_init_script(TOUR_TAKEN)
    page.emulate_media(reduced_motion=motion)
    page.clock.install()
    page.goto(f"{idle.product.url}/runs/{run.id}")
    expect(elites(page)).to_have_text("3 elites")
    page.clock.run_for(2 * FLASH_MS)
    page.clock.pause_at(page.evaluate("Date.now() + 10"))
    run.write_generations(4, 4)
    expect(elites(page)).to_have_text("4 elites")
    page.clock.run_for(FLASH_MS // 4)
    drawn = page.evaluate(WHERE_DRAWN_DIFFERENTLY)["drawn"]
    page.clock.run_for(FLASH_MS)
    flashed = page.evaluate(WHERE_DRAWN_DIFFERENTLY, drawn)["apart"]
    if motion == "reduce":
        assert flashed == []
        return
    assert flashed
    the_map(page).press("ArrowRight")  # To the best elite, which is new.
    left, top, right, bottom = box_of(corners_of_the_marked(page))
    pixel = 0.005
    assert box_of(flashed) == pytest.approx((left, top, right, bottom), abs=pixel)
    inside = [
        at
        for at in flashed
        if left + pixel < at[0] < right - pixel and top + pixel < at[1] < bottom - pixel
    ]
    assert inside == [], "the colour of the cell stays visible"


def corners_of_the_marked(page: Page) -> list[list[float]]:
    """The corners of the marked cell, as shares of the map's sides."""
    points = page.locator(".map-mark polygon").first.get_attribute("points")
    assert points
    return [[float(share) for share in corner.split(",")] for corner in points.split()]


def box_of(points: list[list[float]]) -> tuple[float, float, float, float]:
    xs, ys = zip(*points, strict=True)
    return min(xs), min(ys), max(xs), max(ys)


def test_the_cells_of_a_tessellation_are_voronoi_cells(shared, page):
    page.add_init_script(TOUR_TAKEN)
    run = shared.finished("voronoi")
    with page.expect_response(re.compile("/archive/centroids$"), timeout=SLOW) as answer:
        page.goto(f"{shared.product.url}/runs/{run}")
    assert len(answer.value.json()["centroids"]) == CENTROIDS
    the_map(page).focus()
    corners = set()
    for key in ("ArrowRight", "ArrowLeft", "ArrowDown", "ArrowUp", "ArrowRight"):
        page.keyboard.press(key)
        corners.add(len(corners_of_the_marked(page)))
    assert corners - {4}, "a cell of a grid has four corners, one of a tessellation seldom"


def test_the_tour_scrolls_to_what_it_explains(shared, page):
    page.set_viewport_size({"width": 1280, "height": 800})
    page.goto(f"{shared.product.url}/runs/{shared.finished('search')}")
    tour = page.get_by_role("complementary", name="Tour")
    expect(page.get_by_text(re.compile(r"^\d+ elites$"))).to_be_visible()
    expect(tour).not_to_be_visible()  # It opens by itself over the demonstration only.
    page.get_by_role("button", name="Explain").click()
    expect(tour).to_contain_text("of 256 kinds have one")
    for title in ("Cells are kinds", "Colour is fitness", "The history", "Open a creature"):
        tour.get_by_role("button", name="Next").press("Enter")
        expect(tour.get_by_role("heading", name=title)).to_be_visible()
        if title == "The history":
            expect(page.locator(".time-slider")).to_be_in_viewport(ratio=1)
    expect(page.locator("#elite-measures")).to_contain_text("Fitness")
    tour.get_by_role("button", name="Finish").press("Enter")
    expect(tour).not_to_be_visible()
    page.reload()
    expect(page.get_by_text(re.compile(r"^\d+ elites$"))).to_be_visible()
    expect(tour).not_to_be_visible()
    page.get_by_role("button", name="Explain").click()
    expect(tour).to_be_visible()
    page.keyboard.press("Escape")
    expect(tour).not_to_be_visible()
