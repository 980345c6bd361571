"""The creatures that come with the page are what their files say."""

import json
from pathlib import Path

import jax
import numpy as np
import pytest

from microcosmos.archive import poses
from microcosmos.archive.creature import parse, scene_of
from microcosmos.build import build_block, measures_of
from microcosmos.device import device_kind
from microcosmos.search import evaluate_blocks
from microcosmos.viz.replay import actuator_of

FOLDER = Path(__file__).parents[3] / "web" / "src" / "tank" / "examples"
FILES = json.loads((FOLDER / "creatures.json").read_text())
STREAMS = [
    poses.decode(one) for one in poses.unbatched((FOLDER / "motions.poses").read_bytes())
]


def test_each_has_a_motion_and_a_name_that_is_its_hash():
    assert len(FILES) >= 12
    assert [parse(file)["sha256"] for file in FILES] == [one.creature for one in STREAMS]


@pytest.mark.optimised
def test_their_measures_are_repeated_bit_for_bit():
    files = [parse(file) for file in FILES]
    scene, block = scene_of(files[0]), files[0]["measured"]["block"]
    assert all(scene_of(file) == scene for file in files)
    if files[0]["measured"]["device"] not in (device_kind(), device_kind(portable=False)):
        pytest.skip(f"measured on another device kind: {files[0]['measured']['device']}")
    genotypes = [actuator_of(file, scene) for file in files]
    stacked = jax.tree.map(lambda *each: np.stack(each), *genotypes)
    found = evaluate_blocks(build_block(scene), stacked, block=block)
    names = measures_of(scene)
    for file, values in zip(files, found.measures.tolist(), strict=True):
        assert dict(zip(names, values, strict=True)) == file["measured"]["measures"]


@pytest.mark.parametrize(("file", "stream"), list(zip(FILES, STREAMS, strict=True)))
def test_its_motion_is_as_long_as_its_measured_path(file, stream):
    steps = np.linalg.norm(np.diff(stream.path.astype(float), axis=0), axis=1)
    measures = file["measured"]["measures"]
    # 65 places cut corners of the path of every step.
    assert steps.sum() <= measures["path_length"] * (1 + 1e-5)
    moved = np.linalg.norm(stream.path[-1] - stream.path[0])
    assert moved == pytest.approx(measures["displacement"], rel=1e-4)
