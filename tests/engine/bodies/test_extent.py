"""How far bodies reach along their edges."""

import numpy as np
import pytest

from microcosmos import bodies
from microcosmos.bodies.extent import extent


@pytest.mark.fast
def test_a_body_reaches_as_far_as_its_longest_way_along_edges():
    assert extent(bodies.chain(9, 1.5)) == 12
    np.testing.assert_allclose(extent(bodies.ring(12, 1.0)), 6)
    np.testing.assert_allclose(extent(bodies.star(5, 4, 1.0)), 8)
    np.testing.assert_allclose(extent(bodies.tree(3, 2, 5, 1.0, 0.9)), 20)
