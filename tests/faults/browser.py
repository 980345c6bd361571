"""Chromium, driven by Playwright."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager

from playwright.sync_api import Browser, Page, sync_playwright

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = [
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--disable-gpu",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
]


def executable() -> str | None:
    """The browser of this machine, if it has one."""
    return next(filter(None, map(shutil.which, NAMES)), None)


@contextmanager
def launched(path: str | None = None) -> Iterator[Browser]:
    """Yield a browser without a window."""
    path = path or executable()
    if path is None:
        raise FileNotFoundError(f"needs a browser on PATH, one of {', '.join(NAMES)}")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield browser
        browser.close()


def collect_complaints(page: Page, complaints: list[str]) -> None:
    """Collect the errors and warnings of a page."""

    def note(kind: str, text: str) -> None:
        if kind in ("error", "warning"):
            complaints.append(f"{kind}: {text}")

    page.on("pageerror", lambda error: note("error", str(error)))
    page.on("console", lambda line: note(line.type, f"{line.text} at {line.location['url']}"))
