"""Small archives."""

import pytest

from microcosmos.search.cells import Axis, Grid


@pytest.fixture
def one_axis():
    """A function that makes so many equal cells along one measure from 0 to 1."""

    def make(bins):
        return Grid((Axis(measure=0, low=0.0, high=1.0, bins=bins, logarithmic=False),))

    return make
