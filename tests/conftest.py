"""The marker `long`, skipped tests in continuous integration, and how processes share tests.

`make test` runs what is not long; `make test-all` runs everything. A test is long if it says
so with `pytest.mark.long`, if it drives a browser (one walk through the page excepted), or if
it repeats on PostgreSQL what runs on SQLite too and is not marked `postgresql`. Only files in
`REPEATED` are repeated without the mark.

Processes share the tests by file, and those of one product by folder: pytest-xdist's own
groups (`--dist loadgroup`) are not there with pytest 9.2.
"""

import os
import time
import tomllib
from collections import Counter
from fnmatch import fnmatchcase
from pathlib import Path

import pytest
from hypothesis import settings
from xdist.scheduler import LoadScopeScheduling

SHARING = (
    "tests/faults",
    "tests/e2e",
    "tests/engine/experiments",
    "tests/engine/bodies/growth",
)
"""Folders whose tests share running products, finished runs or grown bodies."""

APART = ("tests/faults/test_cluster.py", "tests/faults/test_group.py")
"""Files there whose tests take minutes and share nothing."""

FIRST = (
    "tests/engine/world/test_native_wheels.py",
    "tests/engine/world/test_native_bits.py",
    "tests/examples",
    "tests/engine/sinks/test_mlflow_server.py",
)
"""Files and folders with few tests that take minutes: they begin early."""

SKIPS = Path(__file__).with_name("skips.toml")
"""Tests that continuous integration may skip."""

DEADLINE = "MICROCOSMOS_TEST_DEADLINE"
"""Variable with the time, in seconds since 1970, after which no long test begins."""

NO_TIME = "no time is left"
"""Reason of a test that would begin after the deadline."""

REPEATED = (
    "tests/server/archives",
    "tests/server/creatures/test_lineage.py",
    "tests/server/estimates",
    "tests/server/phylogenies",
    "tests/server/runs/test_progress.py",
    "tests/server/sweeps/test_summary.py",
    "tests/server/sweeps/test_sweeps.py",
)
"""Files about queries that databases answer in ways of their own (recursion, JSON, order,
windows): their tests run on PostgreSQL too."""

WALK = "tests/e2e/test_walk.py"
"""The one test in a browser that is not long."""

# A busy machine pauses a test for longer than any time limit of one example.
settings.register_profile("patient", deadline=None)
settings.load_profile("patient")


def is_long(item: pytest.Item) -> bool:
    """Tell whether only `make test-all` runs a test."""
    if item.get_closest_marker("long"):
        return True
    if item.nodeid.startswith("tests/e2e"):
        return not item.nodeid.startswith(WALK)
    return is_repetition(item)


def is_repetition(item: pytest.Item) -> bool:
    """Tell whether a test without the mark `postgresql` runs on PostgreSQL."""
    values = getattr(item, "callspec", None)
    repeated = values and values.params.get("database") == "postgresql"
    return bool(repeated and not item.get_closest_marker("postgresql"))


@pytest.hookimpl(tryfirst=True)
def pytest_itemcollected(item: pytest.Item) -> None:
    if is_long(item):
        item.add_marker("long")


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip, and name, long tests that a slow machine would begin after the deadline."""
    deadline = float(os.environ.get(DEADLINE, "inf"))
    if time.time() > deadline and item.get_closest_marker("long"):
        pytest.skip(f"{NO_TIME} for {item.nodeid}")


def refuse_skip(report: pytest.TestReport | pytest.CollectReport) -> None:
    """Turn a skipped test into a failed one in continuous integration, unless it is listed."""
    if os.environ.get("CI") != "true" or not report.skipped or hasattr(report, "wasxfail"):
        return
    allowed = tomllib.loads(SKIPS.read_text())
    reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longrepr
    late = NO_TIME in str(reason)
    if not late and not any(fnmatchcase(report.nodeid, pattern) for pattern in allowed):
        report.outcome = "failed"
        report.longrepr = (
            f"{reason}\ntests/skips.toml does not allow that {report.nodeid} skips"
        )


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport():
    report = yield
    refuse_skip(report)
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report():
    report = yield
    refuse_skip(report)
    return report


def share(nodeid: str) -> str:
    """The group of tests that one process runs: a folder that shares a product, else a file."""
    file = nodeid.partition("::")[0]
    folder = file.rpartition("/")[0]
    return folder if folder.startswith(SHARING) and file not in APART else file


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Leave out repetitions that show nothing new, and sort what takes long, then large files,
    first: no process works alone at the end."""
    items[:] = [
        item for item in items if item.nodeid.startswith(REPEATED) or not is_repetition(item)
    ]
    tests = Counter(share(item.nodeid) for item in items)

    def turn(item: pytest.Item) -> tuple[bool, int, str]:
        mine = share(item.nodeid)
        return not mine.startswith(SHARING + APART + FIRST), -tests[mine], mine

    items.sort(key=turn)


@pytest.hookimpl
def pytest_xdist_make_scheduler(config, log):
    config.option.loadscopereorder = False
    return Shares(config, log)


class Shares(LoadScopeScheduling):
    def _split_scope(self, nodeid: str) -> str:
        return share(nodeid)
