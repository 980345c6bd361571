"""A page that is left open misses nothing, whatever happens to the server meanwhile."""

import re
from typing import Any

import psutil
from drive import Installation, wait_until
from pages import TOUR_TAKEN, best_of, the_map
from playwright.sync_api import Locator, Page, expect
from small_runs import TINY

SLOW = 120_000
SPEC = TINY | {
    "seed": 7,
    "task": TINY["task"] | {"steps": 8000},
    "search": TINY["search"] | {"generations": 5000},
}
"""Longer than the test, which pauses it at the end, by long generations: a page with tens of
thousands of points is slow."""


def test_no_update_is_lost_while_the_server_is_started_again(
    product, page, complaints, new_page
):
    run = product.submit(SPEC)
    page.add_init_script(TOUR_TAKEN)
    page.emulate_media(reduced_motion="reduce")  # So the bodies in the cells compare.
    page.goto(f"{product.url}/runs/{run}?colour=turning")  # Which is asked for as it grows.
    page.evaluate("window.neverReloaded = true")
    product.reach(run, 3)
    expect(connection(page)).to_have_attribute("title", "Live")
    for sent in ("terminate", "kill"):
        before = product.read(run)["generation"]
        restart_server(product, sent)
        assert product.reach(run, before + 3, seconds=120)  # It went on without the server.
        expect(connection(page)).to_have_attribute("title", "Live", timeout=SLOW)
    product.ask(run, "pause")
    product.wait(run, "paused")
    expect(page.get_by_role("button", name=re.compile("^Resume"))).to_be_visible()
    expected = figures_of(product, run)
    wait_until(lambda: figures_on(page) == expected, 10, f"the page shows {expected}")
    anew = new_page()
    anew.add_init_script(TOUR_TAKEN)
    anew.emulate_media(reduced_motion="reduce")
    anew.goto(page.url)
    wait_until(lambda: appearance(page) == appearance(anew), 20, "it looks as if opened anew")
    assert page.evaluate("window.neverReloaded")
    complaints[:] = [text for text in complaints if "net::ERR" not in text]  # It was away.


def restart_server(product: Installation, sent: str) -> None:
    """End the server alone; what started it starts it again."""
    children = psutil.Process(product.process.pid).children()
    server = next(
        child for child in children if child.cmdline()[1:] == ["-m", "microcosmos_server.main"]
    )
    getattr(server, sent)()
    server.wait(30)
    wait_until(product.answers, 60, "the server answers again")


def connection(page: Page) -> Locator:
    return page.get_by_role("status").and_(page.locator(".connection"))


def figures_of(product: Installation, run: str) -> dict[str, Any]:
    curves = product.get(f"runs/{run}/generations")
    return {
        "elites": len(product.get(f"runs/{run}/archive")["cell"]),
        "generation": curves["generation"][-1],
        "QD score": rounded(curves["qd_score"][-1]),
        "Best fitness": rounded(curves["best"][-1]),
        "creature": best_of(product, run)[:8],
    }


def figures_on(page: Page) -> dict[str, Any]:
    return {
        "elites": first_number(page.get_by_text(re.compile(r"^[\d,]+ elites"))),
        "generation": first_number(page.get_by_text(re.compile(r"^[\d,]+ / 5,000$"))),
        "QD score": newest(page, "QD score"),
        "Best fitness": newest(page, "Best fitness"),
        "creature": best_creature(page),
    }


def newest(page: Page, curve: str) -> float:
    """The last value of a curve, from the label of its plot."""
    picture = page.get_by_role("img", name=re.compile(f"^{curve} .*now "))
    name = picture.first.get_attribute("aria-label") or ""
    return rounded(number(name.partition("now")[2]))


def best_creature(page: Page) -> str:
    """The best elite of the archive, to which the first arrow key leads."""
    if "cell=" not in page.url:
        the_map(page).press("ArrowRight")
    return page.locator("#elite-measures code").inner_text()


def first_number(found: Locator) -> float:
    return number(found.first.inner_text())


def number(text: str) -> float:
    found = re.search(r"[\d,.]*\d", text)
    assert found, text
    return float(found[0].replace(",", ""))


def rounded(value: float) -> float:
    """Round as the page does."""
    return float(f"{value:.3g}")


def appearance(page: Page) -> tuple[bytes, list[str | None]]:
    """The archive's map as pixels, and the name of every picture of the run."""
    pictures = page.get_by_role("main").get_by_role("img").all()
    names = [picture.get_attribute("aria-label") for picture in pictures]
    page.mouse.move(0, 0)
    page.evaluate("document.activeElement?.blur()")
    # The body in the inset swims.
    return the_map(page).screenshot(mask=[page.locator("[data-inset]")]), names
