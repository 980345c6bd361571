"""A page that is left open misses nothing, whatever happens to the server meanwhile."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import psutil
import pytest
from drive import Installation, wait_until
from places import TOUR_TAKEN
from playwright.sync_api import Browser, Locator, Page, expect
from small import TINY

FAST, SLOW = 10_000, 120_000
MAP = re.compile("^Archive map")
WINDOW = {"width": 1280, "height": 900}
SPEC = TINY | {"seed": 7, "search": TINY["search"] | {"generations": 5000}}
"""Longer than the test, which pauses it at the end."""


@pytest.mark.e2e
def test_no_update_is_lost_while_the_server_is_started_again(
    product: Installation, page: Page, complaints: list[str], browser: Browser
):
    run = product.submit(SPEC)
    page.add_init_script(TOUR_TAKEN)
    page.goto(f"{product.url}/runs/{run}?colour=turning")  # Which is asked for as it grows.
    page.evaluate("window.neverReloaded = true")
    product.reach(run, 3)
    expect(connection(page)).to_have_attribute("title", "Live", timeout=FAST)
    for sent in ("terminate", "kill"):
        before = product.read(run)["generation"]
        restart_server(product, sent)
        assert product.reach(run, before + 3, seconds=120)  # It went on without the server.
        expect(connection(page)).to_have_attribute("title", "Live", timeout=SLOW)
    product.ask(run, "pause")
    product.wait(run, "paused")
    expect(page.get_by_role("button", name=re.compile("^Resume"))).to_be_visible(timeout=FAST)
    told = told_of(product, run)
    wait_until(lambda: shown(page) == told, 10, f"the page shows {told}")
    with opened_anew(browser, page.url) as anew:
        wait_until(lambda: looks(page) == looks(anew), 20, "it looks as if opened anew")
    assert page.evaluate("window.neverReloaded")
    complaints[:] = [said for said in complaints if "net::ERR" not in said]  # It was away.


def restart_server(product: Installation, sent: str) -> None:
    """End the server alone; what started it starts it again."""
    children = psutil.Process(product.process.pid).children()
    server = next(child for child in children if child.cmdline()[1:] == ["-m", "server.main"])
    getattr(server, sent)()
    server.wait(30)
    wait_until(product.answers, 60, "the server answers again")


def connection(page: Page) -> Locator:
    return page.get_by_role("status").and_(page.locator(".connection"))


def told_of(product: Installation, run: str) -> dict[str, float]:
    """The figures of a paused run in the API."""
    archive = product.http.get(f"/api/v1/runs/{run}/archive").raise_for_status().json()
    curves = product.http.get(f"/api/v1/runs/{run}/generations").raise_for_status().json()
    best = max(range(len(archive["cell"])), key=lambda i: archive["fitness"][i])
    return {
        "elites": len(archive["cell"]),
        "generation": curves["generation"][-1],
        "QD score": rounded(curves["qd_score"][-1]),
        "Best fitness": rounded(curves["best"][-1]),
        "creature": archive["creature"][best][:8],
    }


def shown(page: Page) -> dict[str, Any]:
    """The same figures on the page."""
    return {
        "elites": first_number(page.get_by_text(re.compile(r"^[\d,]+ elites"))),
        "generation": first_number(page.get_by_text(re.compile(r"^[\d,]+ / 5,000$"))),
        "QD score": newest(page, "QD score"),
        "Best fitness": newest(page, "Best fitness"),
        "creature": best_creature(page),
    }


def newest(page: Page, curve: str) -> float:
    """The last value of a curve, which its picture is named with."""
    picture = page.get_by_role("img", name=re.compile(f"^{curve} .*now "))
    name = picture.first.get_attribute("aria-label") or ""
    return rounded(number(name.partition("now")[2]))


def best_creature(page: Page) -> str:
    """The best elite of the archive, to which the first arrow key leads."""
    if "cell=" not in page.url:
        page.get_by_role("application", name=MAP).press("ArrowRight")
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


@contextmanager
def opened_anew(browser: Browser, url: str) -> Iterator[Page]:
    context = browser.new_context(viewport=WINDOW)
    context.add_init_script(TOUR_TAKEN)
    page = context.new_page()
    page.goto(url)
    yield page
    context.close()


def looks(page: Page) -> tuple[bytes, list[str | None]]:
    """The archive's map as pixels, and what every picture of the run is named."""
    pictures = page.get_by_role("main").get_by_role("img").all()
    names = [picture.get_attribute("aria-label") for picture in pictures]
    page.mouse.move(0, 0)
    page.evaluate("document.activeElement?.blur()")
    return page.get_by_role("application", name=MAP).screenshot(), names
