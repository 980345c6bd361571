"""How processes share the tests: by file, and those of one product by folder.

pytest-xdist's own groups (`--dist loadgroup`) are not there with pytest 9.2.
"""

import pytest
from xdist.scheduler import LoadScopeScheduling

SHARING = ("tests/faults", "tests/e2e")
"""Folders, and those in them, whose tests share running products."""


@pytest.hookimpl
def pytest_xdist_make_scheduler(config, log):
    return BySharing(config, log)


class BySharing(LoadScopeScheduling):
    """Gives all tests of a file, or of a folder that shares a product, to one process."""

    def _split_scope(self, nodeid: str) -> str:
        file = nodeid.partition("::")[0]
        folder = file.rpartition("/")[0]
        return folder if folder.startswith(SHARING) else file
