"""The motion of a creature, cut from its replay."""

import json
import struct

import numpy as np
import pytest

from microcosmos.archive import creature
from server.renderings import storage as renderings
from server.tables import REPLAY


@pytest.fixture
def known(api, identity) -> str:
    file = creature.document(identity(3), None, None)
    return api.post("creatures", json=file).json()["creature"]


def recorded(positions: np.ndarray) -> bytes:
    """A replay with these positions, (frame, node, 2), and some fluid behind them."""
    frames, nodes, _ = positions.shape
    header = {
        "format": "microcosmos-replay/2",
        "frames": frames,
        "every": 5,
        "steps": 5 * (frames - 1),
        "nodes": nodes,
        "edges": [[0, 1], [1, 2]],
        "size": [8, 4],
        "vorticity": {"scale": 1.0},
    }
    told = json.dumps(header).encode()
    fluid = np.ones((frames, 8, 4), np.int8).tobytes()
    return struct.pack("<I", len(told)) + told + positions.astype("<f4").tobytes() + fluid


def read(data: bytes) -> tuple[dict, np.ndarray]:
    (length,) = struct.unpack_from("<I", data)
    header = json.loads(data[4 : 4 + length])
    positions = np.frombuffer(data[4 + length :], "<f4")
    return header, positions.reshape(header["frames"], header["nodes"], 2)


@pytest.mark.parametrize(("frames", "stride"), [(7, 1), (96, 1), (97, 2), (1001, 11)])
def test_it_is_every_kth_frame_of_the_replay(api, services, known, frames, stride):
    positions = np.random.default_rng(0).normal(size=(frames, 3, 2)).astype(np.float32)
    renderings.save(services, known, REPLAY, recorded(positions))
    answer = api.get(f"creatures/{known}/motion")
    header, motion = read(answer.content)
    np.testing.assert_array_equal(motion, positions[::stride])
    assert header["every"] == 5 * stride
    assert (header["nodes"], header["edges"], header["size"]) == (3, [[0, 1], [1, 2]], [8, 4])
    again = api.get(
        f"creatures/{known}/motion", headers={"If-None-Match": answer.headers["etag"]}
    )
    assert (again.status_code, again.content) == (304, b"")


def test_it_has_the_replay_recorded_where_there_is_none(api, services, known):
    answer = api.get(f"creatures/{known}/motion")
    assert (answer.status_code, answer.json()) == (202, {"status": "rendering"})
    assert services.jobs.renderings.count == 1
