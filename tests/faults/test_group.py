"""The drill for a group, small: `make acceptance PARTS=group` is its full size."""

import group
import pytest

pytestmark = pytest.mark.long


def test_the_runs_of_a_group_survive_a_bad_night(start_product):
    assert group.drill(start_product(WORKERS="0"), group.SMALL) == []
