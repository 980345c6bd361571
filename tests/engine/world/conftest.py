"""What the tests of the native kernel's compilers share."""

from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def zig_cache():
    """The folder with the C++ library that Zig compiles once for each processor.

    It is shared by all processes; deleting it is always safe.
    """
    return str(Path(__file__).parents[3] / ".cache" / "zig")
