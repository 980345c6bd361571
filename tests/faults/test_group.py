"""The drill for a group, small: `make acceptance PARTS=group` is its full size."""

import group
import pytest
from webhook import Receiver

pytestmark = pytest.mark.long


def test_the_runs_of_a_group_survive_a_bad_night(start_product):
    receiver = Receiver()
    with receiver.serve() as url:
        product = start_product(WORKERS="0", **group.telling(url))
        assert group.drill(product, group.SMALL, receiver) == []
