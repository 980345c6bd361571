"""Fixtures of tests in a browser: products started as `make run` does.

Starting a product and compiling its programs take longer than most tests. So tests share:
`shared` has small runs of each kind, and computes what else is submitted there; at `idle`
nobody computes: files whose tests need no more are in without_workers/. A test that needs a new
installation, or ends the server, is in own_product/. A process takes one of the three folders.
"""

from typing import NamedTuple

import pytest
from browser import collect_complaints, executable, launched
from databases import own_redis
from drive import QUICK, ROOT, Installation, running
from playwright.sync_api import expect
from small_runs import submit_small_runs

from microcosmos_server.services.services import Services, connect
from microcosmos_server.settings import Settings

WINDOW = {"width": 1280, "height": 900}
ACTION_MS = 120_000
ODD_NAME = "data?1 #%:;& жизнь"
"""A data folder is where its name says, whatever that is."""

expect.set_options(timeout=30_000)


class Shared(NamedTuple):
    product: Installation
    submitted: dict[str, str]

    def finished(self, name: str) -> str:
        """The id of a small run, once it is finished."""
        self.product.wait(self.submitted[name], "finished", seconds=300)
        return self.submitted[name]


class Idle(NamedTuple):
    """A running product without workers; tests write generations with its services."""

    product: Installation
    services: Services


@pytest.fixture(scope="package")
def browser():
    if not (path := executable()):
        pytest.skip("needs Chromium on PATH")
    with launched(path) as browser:
        yield browser


@pytest.fixture(scope="package")
def product_settings(browser):
    """The environment of every product of the session."""
    if not (ROOT / "web" / "dist" / "index.html").exists():
        pytest.fail("web/dist is missing: build the page first")
    return QUICK | {"MICROCOSMOS_DEMONSTRATION": "false"}


@pytest.fixture
def product(product_settings, tmp_path):
    with running(tmp_path / "data", product_settings) as product:
        yield product


@pytest.fixture(scope="package")
def shared(product_settings, tmp_path_factory):
    """One product for most tests, which computes a run of each kind."""
    with running(tmp_path_factory.mktemp("shared") / ODD_NAME, product_settings) as product:
        yield Shared(product, submit_small_runs(product))


@pytest.fixture(scope="package")
def idle(product_settings, tmp_path_factory):
    """One product without workers, whose Redis the tests use too."""
    folder = tmp_path_factory.mktemp("idle")
    with own_redis(folder) as url:
        environment = {"WORKERS": "0", "MICROCOSMOS_REDIS_URL": url}
        with running(folder / ODD_NAME, product_settings | environment) as product:
            services = connect(Settings(data=folder / ODD_NAME, redis_url=url))
            yield Idle(product, services)
            services.close()


@pytest.fixture
def new_page(browser):
    """Opens pages in browsers of their own, without cookies or stored data."""
    contexts = []

    def open_page():
        contexts.append(browser.new_context(viewport=WINDOW))
        page = contexts[-1].new_page()
        page.set_default_timeout(ACTION_MS)
        return page

    yield open_page
    for context in contexts:
        context.close()


@pytest.fixture
def anonymous_page(new_page):
    return new_page()


@pytest.fixture
def complaints():
    """Errors and warnings of `page`; a test removes those that it expects."""
    return []


@pytest.fixture
def page(new_page, complaints):
    """A page of which any complaint fails the test; it is closed before the server ends."""
    page = new_page()
    collect_complaints(page, complaints)
    yield page
    page.context.close()
    assert complaints == []
