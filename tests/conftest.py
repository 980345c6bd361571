"""The marker `long`, and how processes share the tests.

`make test` runs what is not long; `make test-all` runs everything. A test is long if it says
so with `pytest.mark.long`, if it drives a browser (one walk through the page excepted), or if
it repeats on PostgreSQL what runs on SQLite too and is not marked `postgresql`.

Processes share the tests by file, and those of one product by folder: pytest-xdist's own
groups (`--dist loadgroup`) are not there with pytest 9.2.
"""

import os
import time
from collections import Counter

import pytest
from xdist.scheduler import LoadScopeScheduling

SHARING = (
    "tests/faults",
    "tests/e2e",
    "tests/engine/experiments",
    "tests/engine/bodies/growth",
)
"""Folders whose tests share running products, finished runs or grown bodies."""

DEADLINE = "MICROCOSMOS_TEST_DEADLINE"
"""Variable with the time, in seconds since 1970, after which no long test begins."""

WALK = "tests/e2e/test_walk.py"
"""The one test in a browser that is not long."""


def is_long(item: pytest.Item) -> bool:
    """Tell whether only `make test-all` runs a test."""
    if item.get_closest_marker("long"):
        return True
    if item.nodeid.startswith("tests/e2e"):
        return not item.nodeid.startswith(WALK)
    values = getattr(item, "callspec", None)
    repeated = values and values.params.get("database") == "postgresql"
    return bool(repeated and not item.get_closest_marker("postgresql"))


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip, and name, long tests that a slow machine would begin after the deadline."""
    deadline = float(os.environ.get(DEADLINE, "inf"))
    if time.time() > deadline and item.get_closest_marker("long"):
        pytest.skip(f"no time is left for {item.nodeid}")


@pytest.hookimpl(tryfirst=True)
def pytest_itemcollected(item: pytest.Item) -> None:
    if is_long(item):
        item.add_marker("long")


def share(nodeid: str) -> str:
    """The group of tests that one process runs: a folder that shares a product, else a file."""
    file = nodeid.partition("::")[0]
    folder = file.rpartition("/")[0]
    return folder if folder.startswith(SHARING) else file


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Sort folders, then large files, first: no process works alone at the end."""
    tests = Counter(share(item.nodeid) for item in items)

    def turn(item: pytest.Item) -> tuple[bool, int, str]:
        mine = share(item.nodeid)
        return not mine.startswith(SHARING), -tests[mine], mine

    items.sort(key=turn)


@pytest.hookimpl
def pytest_xdist_make_scheduler(config, log):
    config.option.loadscopereorder = False
    return Shares(config, log)


class Shares(LoadScopeScheduling):
    def _split_scope(self, nodeid: str) -> str:
        return share(nodeid)
