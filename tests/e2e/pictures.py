"""Pictures of every page into docs/pictures/page: `make pictures`, or `make pictures DATA=…`.

Each page in two themes and at three widths, over a data folder with finished runs. In a new one
the demonstration, the smallest preset of each other experiment, a sweep and the run of the
README are carried out first. Fails where something is cut off, too wide or drawn over something
else.
"""

import io
import os
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

import numpy as np
from browser import collect_complaints, launched
from drive import ROOT, Installation, running
from layout import THEMES, WIDTHS, faults
from pages import NOWHERE, TOUR_TAKEN, hold_still, product_pages, visit
from PIL import Image
from playwright.sync_api import Browser, Page, TimeoutError

FOLDER = ROOT / "docs" / "pictures" / "page"
COLOURS = 256
GALLERY = "[data-gallery]"
AREA = 1280 * 1300
"""Pixels of a picture: what one sees before scrolling far."""
HOUR = 3600
SWEEP = {
    "name": "Thin and thick",
    "spec": {
        "experiment": "quality-diversity",
        "world": {"width": 32, "height": 32},
        "body": {"nodes": 16},
        "search": {"generations": 60, "batch": 16},
    },
    "seeds": 3,
    "grid": {"world.viscosity": [0.05, 0.2, 0.8]},
}


def main() -> None:
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(os.environ.get("DATA") or temporary).resolve()
        new = not folder.exists() or not any(folder.iterdir())
        with running(folder, {}) as product, launched() as browser:
            if new:
                carry_out(product)
            wrong = take_all(browser, product.url)
    size = sum(file.stat().st_size for file in FOLDER.glob("*.png"))
    print(f"{len(list(FOLDER.glob('*.png')))} pictures, {size / 1e6:.1f} MB, in {FOLDER}")
    sys.exit("\n".join(wrong) if wrong else None)


def carry_out(product: Installation) -> None:
    """Run the first preset of each experiment, a sweep, and the README's run."""
    presets = {one["experiment"]: one["presets"] for one in product.get("experiments")}
    for experiment, known in presets.items():
        if experiment != "quality-diversity" and known:
            product.submit(known[0]["spec"])
    product.http.post("/api/v1/sweeps", json=SWEEP).raise_for_status()
    standard = next(one for one in presets["quality-diversity"] if one["name"] == "standard")
    search = standard["spec"]["search"] | {"generations": 120}
    product.submit(standard["spec"] | {"search": search})
    for run in product.get("runs")["items"]:
        product.wait(run["id"], "finished", seconds=HOUR)
        print(f"{run['experiment']} is finished", flush=True)


def take_all(browser: Browser, address: str) -> list[str]:
    """Take a picture of every page in every theme and width, and return the faults."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    wrong: list[str] = []
    for theme in THEMES:
        for width, height in WIDTHS.items():
            context = browser.new_context(
                viewport={"width": width, "height": height}, color_scheme=theme
            )
            context.add_init_script(TOUR_TAKEN)
            page = context.new_page()
            collect_complaints(page, wrong)
            for target in product_pages(address):
                name = f"{target.name}-{width}-{theme}"
                if not visit(page, address, target, HOUR):
                    wrong.append(f"{name}: {NOWHERE}")
                    continue
                hold_still(page)
                page.wait_for_timeout(1500)  # What moves in by itself has done so.
                wrong += [f"{name}: {fault}" for fault in faults(page)]
                save(photographed(page, width, height), name)
                print(name, flush=True)
            context.close()
    return [one for one in wrong if not one.endswith("/nowhere")]  # 404 is its status.


def photographed(page: Page, width: int, height: int) -> bytes:
    """A picture of the page in a window as high as the page, within limits."""
    whole = page.evaluate("document.documentElement.scrollHeight")
    high = max(height, min(whole, AREA // width))
    page.set_viewport_size({"width": width, "height": high})
    page.evaluate("scrollTo(0, 0)")  # A replay that was held still was scrolled to.
    page.wait_for_timeout(300)  # What is as large as the window allows has been drawn again.
    await_poses(page)
    png = page.screenshot()
    if page.locator(GALLERY).count():  # At the beginning of its loop every body is straight.
        page.wait_for_timeout(1700)
        png = max(png, page.screenshot(), key=len)
    page.set_viewport_size({"width": width, "height": height})
    return png


def await_poses(page: Page) -> None:
    """Wait until a gallery has requested no pose stream for three seconds."""
    if page.locator(GALLERY).count():
        with suppress(TimeoutError):
            while True:
                page.wait_for_event("request", lambda one: "/poses" in one.url, timeout=3000)


def save(png: bytes, name: str) -> None:
    """Save a picture in few colours, each the most frequent one of its pixels."""
    picture = Image.open(io.BytesIO(png)).convert("RGB")
    method, still = Image.Quantize.MAXCOVERAGE, Image.Dither.NONE
    few = picture.quantize(COLOURS, method=method, dither=still)
    pixels, places = np.asarray(picture).reshape(-1, 3), np.asarray(few).ravel()
    palette = np.zeros((COLOURS, 3), np.uint8)
    for place in np.unique(places):
        there, counts = np.unique(pixels[places == place], axis=0, return_counts=True)
        palette[place] = there[counts.argmax()]
    few.putpalette(palette.tobytes())
    few.save(FOLDER / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main()
