"""How processes share the tests: by file, and those of one product by folder.

pytest-xdist's own groups (`--dist loadgroup`) are not there with pytest 9.2.
"""

from collections import Counter

import pytest
from xdist.scheduler import LoadScopeScheduling

SHARING = ("tests/faults", "tests/e2e")
"""Folders, and those in them, whose tests share running products."""


def share(nodeid: str) -> str:
    """What goes to one process: the folder where that shares a product, else the file."""
    file = nodeid.partition("::")[0]
    folder = file.rpartition("/")[0]
    return folder if folder.startswith(SHARING) else file


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The longest first, lest one process works alone at the end: folders, then large files."""
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
    """Gives every share of the tests to one process, in the order of collection."""

    def _split_scope(self, nodeid: str) -> str:
        return share(nodeid)
