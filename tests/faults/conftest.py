"""Fixtures with real servers, workers, databases and queues, which tests disturb."""

from contextlib import ExitStack

import pytest
from drive import SHORT, running
from small_spec import SMALL_SCENE


@pytest.fixture
def start_product(tmp_path):
    """Starts an installation with these settings."""
    with ExitStack() as stack:
        yield lambda **more: stack.enter_context(running(tmp_path / "data", SHORT | more))


@pytest.fixture(scope="package")
def product(tmp_path_factory):
    """A running installation with two workers, which all tests may disturb."""
    with running(tmp_path_factory.mktemp("data"), SHORT | {"WORKERS": "2"}) as product:
        yield product


@pytest.fixture(scope="session")
def spec():
    """A search that is not over before a test has disturbed it."""
    search = {"generations": 40, "batch": 16, "block": 8}
    return SMALL_SCENE | {"seed": 7, "search": search}


@pytest.fixture(scope="package")
def undisturbed(product, spec):
    """The results of an undisturbed run."""
    run = product.submit(spec)
    product.wait(run, "finished", seconds=300)  # It has to compile.
    return product.results(run)
