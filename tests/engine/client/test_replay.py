"""A replay in a notebook is self-contained and of limited size."""

import json
import re
from base64 import b64decode
from gzip import decompress
from html import unescape

import numpy as np
import pytest

from microcosmos.client import Replay
from microcosmos.viz import motion
from microcosmos.widgets import assets


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


@pytest.fixture(autouse=True)
def built():
    """The page of a replay is built by `make web`."""
    try:
        assets.page()
    except FileNotFoundError as error:
        pytest.skip(str(error))


def within(page, name):
    (found,) = re.findall(rf'<script type="text/plain" id="{name}">(.*?)</script>', page)
    return found


def test_the_page_holds_the_motion_and_says_what_it_leaves_out(recording):
    for size, note in (((32, 24), ""), ((256, 128), "256 × 128 cells in squares of 3 × 3")):
        data, _, _ = recording(31, 10, size)
        replay = Replay(data)
        about = json.loads(within(replay.html, "about"))
        assert about["title"] == repr(replay)[1:-1]
        assert note in about["note"]
        assert bool(about["note"]) == bool(note)
        kept = decompress(b64decode(within(replay.html, "motion")))
        assert kept == motion.encode(replay.motion)


def test_a_notebook_shows_it_in_a_frame_of_its_own_and_saves_it(tmp_path, recording):
    data, _, _ = recording(3, 4, (16, 8))
    replay = Replay(data)
    assert replay.save(tmp_path / "one.replay").read_bytes() == data
    assert replay.save(tmp_path / "one.HTML").read_text() == replay.html
    bundle = replay._repr_mimebundle_()
    assert bundle["text/plain"] == repr(replay)
    assert "10 steps in 16 × 8 cells" in repr(replay)
    html = bundle["text/html"]
    (inside,) = re.findall(r'srcdoc="([^"]*)"', html)
    assert unescape(inside) == replay.html
    assert 'sandbox="allow-scripts"' in html
    assert html.count("<b>") == 0  # The file's own names are no markup.
    assert "default-src 'none'" in replay.html  # No network.


def test_bytes_that_hold_no_replay_are_refused():
    with pytest.raises(ValueError, match="header"):
        Replay(b"\xff\xff\xff\xff{}")
