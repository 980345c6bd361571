"""The archive of a run: map, time, gallery."""

import re

import pytest
from pages import TOUR_TAKEN, best_of, elites, see_it_move, the_map
from playwright.sync_api import expect

SLOW = 120_000


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


@pytest.fixture
def searched(shared, page):
    """A finished search whose page is open, without the tour."""
    page.add_init_script(TOUR_TAKEN)
    run = shared.finished("search")
    page.goto(f"{shared.product.url}/runs/{run}")
    return run


def test_arrow_keys_walk_the_map_and_enter_opens_a_creature(shared, page, searched):
    the_map(page).focus()
    page.keyboard.press("ArrowRight")
    best = best_of(shared.product, searched)
    reading = page.locator("#elite-measures")
    expect(reading).to_contain_text(best[:8])
    see_it_move(page.locator("[data-inset] canvas"))
    page.keyboard.press("ArrowLeft")
    expect(reading).not_to_contain_text(best[:8])
    other = reading.locator("code").inner_text()
    page.keyboard.press("Enter")
    page.wait_for_url(re.compile(f"/creatures/{other}"))


def test_the_slider_shows_the_archive_of_every_generation(shared, page, searched):
    def count(**then):
        return f"{len(shared.product.get(f'runs/{searched}/archive', **then)['cell'])} elites"

    for generation in (1, 20):
        page.get_by_role("slider", name="Generation shown").fill(str(generation))
        expect(elites(page)).to_have_text(count(generation=generation))
    page.wait_for_url(re.compile("at=20"))
    page.reload()
    expect(elites(page)).to_have_text(count(generation=20))
    page.get_by_role("button", name="Newest").click()
    expect(elites(page)).to_have_text(count())


def test_a_gallery_moves_and_needs_no_renderer_for_the_body_of_every_tile(
    shared, page, searched
):
    bins = shared.product.get(f"runs/{searched}/archive")["axes"][0]["bins"]
    expect(the_map(page)).to_be_visible()
    page.get_by_role("button", name="Gallery").click()
    page.wait_for_function(ALL_BODIES, arg=bins, timeout=SLOW)
    filled, bodies = page.evaluate(TILES, bins)
    assert filled == bodies > 10
    see_it_move(page.locator("[data-gallery] canvas"))
    asked = page.evaluate("performance.getEntriesByType('resource').map((one) => one.name)")
    assert any("/archive/poses?" in url for url in asked), "by the map or by the gallery"
    assert [url for url in asked if "/creatures/" in url] == [], "which may render"
