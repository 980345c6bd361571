"""Pictures of every page into docs/pictures/page: `make pictures`, or `make pictures DATA=…`.

Each page in two themes and at three widths, over a data folder with finished runs, or a fresh
one, in which the demonstration and the smallest preset of each other experiment are carried
out first. Fails where something is cut off, too wide or drawn over something else.
"""

import io
import os
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))

from browser import launched, overhear
from drive import ROOT, Installation
from looks import THEMES, WIDTHS, faults
from PIL import Image
from places import GUIDED, NOWHERE, hold_still, places, visit
from playwright.sync_api import Browser

FOLDER = ROOT / "docs" / "pictures" / "page"
COLOURS = 256
AREA = 1280 * 1300
"""Pixels of a picture from the top of its page: what one sees before scrolling far."""
HOUR = 3600


def main() -> None:
    given = os.environ.get("DATA")
    with tempfile.TemporaryDirectory() as folder:
        settings = {"WORKERS": "0"} if given else {}
        place = Installation(Path(given or folder).resolve(), settings)
        place.start()
        try:
            if not given:
                carry_out(place)
            with launched() as browser:
                wrong = take_all(browser, place.url)
        finally:
            place.end()
            place.close()
    size = sum(file.stat().st_size for file in FOLDER.glob("*.png"))
    print(f"{len(list(FOLDER.glob('*.png')))} pictures, {size / 1e6:.1f} MB, in {FOLDER}")
    sys.exit("\n".join(wrong) if wrong else None)


def carry_out(place: Installation) -> None:
    """The demonstration that a new folder begins with, and the others' first presets."""
    experiments = place.http.get("/api/v1/experiments").raise_for_status().json()
    for one in experiments:
        if one["experiment"] != "quality-diversity" and one["presets"]:
            place.submit(one["presets"][0]["spec"])
    for run in place.http.get("/api/v1/runs").raise_for_status().json()["items"]:
        place.wait(run["id"], "finished", seconds=HOUR)
        print(f"{run['experiment']} is finished", flush=True)


def take_all(browser: Browser, address: str) -> list[str]:
    """A picture of every page in every theme and width; what is wrong with them."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    wrong: list[str] = []
    for theme in THEMES:
        for width, height in WIDTHS.items():
            context = browser.new_context(
                viewport={"width": width, "height": height}, color_scheme=theme
            )
            context.add_init_script(GUIDED)
            page = context.new_page()
            overhear(page, wrong)
            for place in places(address):
                name = f"{place.name}-{width}-{theme}"
                if not visit(page, address, place, HOUR):
                    wrong.append(f"{name}: {NOWHERE}")
                    continue
                hold_still(page)
                page.wait_for_timeout(1500)  # What moves in by itself has done so.
                wrong += [f"{name}: {fault}" for fault in faults(page)]
                save(page.screenshot(full_page=True), name)
                print(name, flush=True)
            context.close()
    return wrong


def save(png: bytes, name: str) -> None:
    """Keep a picture in few colours, which these pages have, and without what is far below."""
    picture = Image.open(io.BytesIO(png)).convert("RGB")
    top = picture.crop((0, 0, picture.width, min(picture.height, AREA // picture.width)))
    few = top.quantize(COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    few.save(FOLDER / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main()
