"""A replay in a notebook is self-contained and of limited size."""

import json
import re
from base64 import b64decode
from html import unescape

import numpy as np
import pytest

from microcosmos.client import Replay
from microcosmos.client import replay as module


@pytest.fixture
def recording(replay_bytes):
    """A function that makes the bytes of a random replay, its positions and its levels."""

    def make(frames, nodes, size):
        random = np.random.default_rng(0)
        positions = random.uniform(0, 50, (frames, nodes, 2)).astype("<f4")
        levels = random.integers(-127, 128, (frames, *size)).astype(np.int8)
        edges = [[k, k + 1] for k in range(nodes - 1)]
        creature = "</script><b>" + "ab" * 26
        return replay_bytes(positions, edges, levels, creature=creature), positions, levels

    return make


def within(page, name):
    (found,) = re.findall(rf'<script id="{name}"[^>]*>(.*?)</script>', page, re.DOTALL)
    return found


def test_a_small_replay_is_embedded_whole(recording):
    data, positions, levels = recording(31, 10, (32, 24))
    replay = Replay(data)
    header = json.loads(within(replay.html, "header"))
    assert (header["frames"], header["every"], header["note"]) == (31, 5, "")
    assert b64decode(within(replay.html, "positions")) == positions.tobytes()
    assert b64decode(within(replay.html, "levels")) == levels.tobytes()


def test_a_large_one_is_thinned_with_a_note(recording):
    data, positions, levels = recording(251, 400, (256, 128))
    page = Replay(data).html
    header = json.loads(within(page, "header"))
    assert len(page) < 1.4 * module.LIMIT + 20_000
    assert header["grid"] == [85, 42]
    assert header["every"] > 5
    step = header["every"] // 5
    assert f"one frame in {step}" in header["note"]
    assert "of 256 × 128 cells" in header["note"]
    shown = np.frombuffer(b64decode(within(page, "positions")), "<f4")
    np.testing.assert_array_equal(shown.reshape(-1, 400, 2), positions[::step])
    mean = levels[0, 3:6, 6:9].astype(float).mean()
    kept = np.frombuffer(b64decode(within(page, "levels")), np.int8).reshape(-1, 85, 42)
    assert kept[0, 1, 2] == round(mean)


def test_a_notebook_shows_it_in_a_frame_of_its_own_and_saves_it(tmp_path, recording):
    data, _, _ = recording(3, 4, (16, 8))
    replay = Replay(data)
    assert replay.save(tmp_path / "one.replay").read_bytes() == data
    assert replay.save(tmp_path / "one.html").read_text() == replay.html
    bundle = replay._repr_mimebundle_()
    assert bundle["text/plain"] == repr(replay)
    assert "10 steps in 16 × 8 cells" in repr(replay)
    html = bundle["text/html"]
    (inside,) = re.findall(r'srcdoc="([^"]*)"', html)
    assert unescape(inside) == replay.html
    assert 'sandbox="allow-scripts"' in html
    assert html.count("<b>") == 0  # The file's own names are no markup.
    assert not re.search(r"https?://|src=|@import|fetch\(", replay.html)  # No network.


def test_bytes_that_hold_no_replay_are_refused():
    with pytest.raises(ValueError, match="header"):
        Replay(b"\xff\xff\xff\xff{}")
