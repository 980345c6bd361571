"""A small run, and archives of other kinds that tests make up."""

import made_archives
import pytest
from small_spec import SMALL_RUN

from microcosmos import spec
from microcosmos.build.local import evolve


@pytest.fixture(scope="session")
def ran(tmp_path_factory):
    """The path of an archive file, with the best creature beside it."""
    path = tmp_path_factory.mktemp("run") / "small.h5"
    evolve(spec.parse(SMALL_RUN), path)
    return path


@pytest.fixture
def made():
    return made_archives.made
