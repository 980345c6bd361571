"""What was simulated by hand can be watched in a notebook."""

from base64 import b64decode

import numpy as np
import pytest

from microcosmos.viz.notebook import filmed, show
from microcosmos.viz.replay_file import read_replay

pytestmark = pytest.mark.long


def test_own_frames_become_a_replay_of_the_same_motion(swimming):
    made = filmed(swimming.positions, swimming.edges, swimming.vorticity, every=5)
    np.testing.assert_array_equal(made.positions, swimming.positions)
    np.testing.assert_array_equal(made.edges, swimming.edges)
    np.testing.assert_allclose(made.vorticity, swimming.vorticity, atol=made.quantum)
    assert (made.size, made.step(2)) == (swimming.size, 10)


def test_a_replay_plays_as_a_picture_in_the_page(eel):
    html = show(eel, width=64, frames=4)._repr_html_()
    data = b64decode(html.split("base64,")[1].partition('"')[0])
    assert data.startswith(b"GIF89a")
    assert data == show(read_replay(eel), width=64, frames=4).data


def test_frames_that_do_not_match_are_refused(swimming):
    with pytest.raises(ValueError, match=r"`positions` must be \(frame, node, 2\)"):
        filmed(swimming.positions[1:], swimming.edges, swimming.vorticity)
