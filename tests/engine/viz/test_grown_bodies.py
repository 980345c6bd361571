"""A replay of a body that a plan grew holds the nodes, edges and joints that have grown."""

import numpy as np
import pytest
from grown_bodies import grown_file, grown_scene

from microcosmos.spec.creature import Identity
from microcosmos.viz.raster import frame
from microcosmos.viz.replay import record
from microcosmos.viz.replay_file import read_replay


@pytest.mark.long
def test_a_replay_holds_the_grown_body_and_its_rest_shapes():
    file = grown_file(grown_scene())
    body = Identity.model_validate(file["identity"]).shape
    film = read_replay(record(file))
    np.testing.assert_array_equal(film.edges, body.edges)
    np.testing.assert_array_equal(film.header["joints"], body.joints)
    first = film.positions[0] - film.positions[0].mean(0)
    np.testing.assert_allclose(first, body.positions - body.positions.mean(0), atol=1e-4)
    assert film.drive is not None
    # The drive rises from the body at rest.
    np.testing.assert_allclose(film.drive.angles[0], body.rest_angle, atol=0.1)
    assert film.drive.lengths.shape == (film.frames, 26)
    assert np.abs(film.drive.angles - body.rest_angle[None]).max() > 0.1
    assert frame(film, film.frames - 1, width=160).std() > 0
