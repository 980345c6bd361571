"""The whole product in a browser: started as `make run` does, and looked at.

Starting a product and compiling its programs take longer than most tests. So tests share:
`shared_address` has small runs of each kind, and computes what else is submitted there;
at `idle.product` nobody computes. A test that needs a list of runs of its own, or ends the
server, has an `address` of its own, and is in alone/: two processes share the folders.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

import pytest
from browser import executable, launched, overhear
from databases import own_redis
from drive import QUICK, ROOT, Installation, running
from playwright.sync_api import Browser, Page
from small import submit_small_runs

from server.services.services import Services, connect
from server.settings import Settings

HERE = Path(__file__).parent
WINDOW = {"width": 1280, "height": 900}
PATIENCE_S = 120


class Shared(NamedTuple):
    """A running product with small runs, by name."""

    product: Installation
    submitted: Mapping[str, str]

    def finished(self, name: str) -> str:
        """The id of a small run, once it is finished."""
        self.product.wait(self.submitted[name], "finished", seconds=300)
        return self.submitted[name]


class Idle(NamedTuple):
    """A running product without workers; tests write generations with its services."""

    product: Installation
    services: Services


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Run tests without workers first, while the shared runs are computed."""
    items.sort(key=turn)


def turn(item: pytest.Item) -> int:
    if HERE not in item.path.parents:
        return 0
    return 2 if needs(item, "shared") else 1 if needs(item, "idle") else 3


def needs(item: pytest.Item, fixture: str) -> bool:
    return fixture in getattr(item, "fixturenames", ())


@pytest.fixture(scope="session")
def chromium() -> str:
    found = executable()
    if found is None:
        pytest.skip("needs Chromium on PATH")
    return found


@pytest.fixture(scope="package")
def browser(chromium: str) -> Iterator[Browser]:
    with launched(chromium) as browser:
        yield browser


@pytest.fixture(scope="session")
def common() -> dict[str, str]:
    """The environment of every product of the session."""
    if not (ROOT / "web" / "dist" / "index.html").exists():
        pytest.fail("web/dist is missing: build the page first")
    return QUICK | {"MICROCOSMOS_DEMONSTRATION": "false"}


@pytest.fixture
def product(chromium: str, common: dict[str, str], tmp_path: Path) -> Iterator[Installation]:
    """The whole product over an empty data folder."""
    with running(tmp_path / "data", common) as place:
        yield place


@pytest.fixture
def address(product: Installation) -> str:
    """The address of the empty product."""
    return product.url


@pytest.fixture(scope="package")
def shared(
    chromium: str, common: dict[str, str], tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Shared]:
    """One product for most tests, which computes a run of each kind."""
    with running(tmp_path_factory.mktemp("shared") / "data", common) as place:
        yield Shared(place, submit_small_runs(place))


@pytest.fixture(scope="package")
def idle(
    request: pytest.FixtureRequest,
    chromium: str,
    common: dict[str, str],
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[Idle]:
    """One product without workers, whose Redis the tests use too."""
    if any(needs(item, "shared") for item in request.session.items):
        request.getfixturevalue("shared")  # It computes meanwhile.
    folder = tmp_path_factory.mktemp("idle")
    with own_redis(folder) as url:
        environment = {"WORKERS": "0", "MICROCOSMOS_REDIS_URL": url}
        with running(folder / "data", common | environment) as place:
            services = connect(Settings(data=folder / "data", redis_url=url))
            yield Idle(place, services)
            services.close()


@pytest.fixture
def shared_address(shared: Shared) -> str:
    return shared.product.url


@pytest.fixture
def stranger(browser: Browser) -> Iterator[Page]:
    """A page in another browser, without cookies or stored data."""
    context = browser.new_context(viewport=WINDOW)
    page = context.new_page()
    page.set_default_timeout(300_000)
    yield page
    context.close()


@pytest.fixture
def complaints() -> list[str]:
    """Errors and warnings of pages; a test removes those that it expects."""
    return []


@pytest.fixture
def page(browser: Browser, address: str, complaints: list[str]) -> Iterator[Page]:
    """A page that is closed before the server ends; any complaint of it fails the test."""
    yield from opened(browser, complaints)


@pytest.fixture
def shared_page(browser: Browser, shared: Shared, complaints: list[str]) -> Iterator[Page]:
    """The same, for the shared product."""
    yield from opened(browser, complaints)


@pytest.fixture
def idle_page(browser: Browser, idle: Idle, complaints: list[str]) -> Iterator[Page]:
    """The same, for the product without workers."""
    yield from opened(browser, complaints)


def opened(browser: Browser, complaints: list[str]) -> Iterator[Page]:
    context = browser.new_context(viewport=WINDOW)
    page = context.new_page()
    overhear(page, complaints)
    page.set_default_timeout(PATIENCE_S * 1000)
    yield page
    context.close()
    assert complaints == []
