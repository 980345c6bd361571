"""TensorBoard's own reader finds each step of a run once, the last attempt's."""

import json

import numpy as np
import pytest
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from microcosmos.archive.file import load


def read(folder):
    (found,) = [one for one in folder.iterdir() if one.is_dir()]
    events = EventAccumulator(str(found))
    events.Reload()
    return found, events


def test_curves_pictures_and_files_of_a_run(plain, followed):
    path = followed / "run.h5"
    assert path.read_bytes() == plain.read_bytes()
    folder, events = read(followed / "events")
    curves = load(path.read_bytes())[0]["curves"]
    for name in ("qd_score", "coverage", "best", "evaluations"):
        found = events.Scalars(name)
        assert [one.step for one in found] == [1, 2, 3, 4]
        np.testing.assert_array_equal([one.value for one in found], np.float32(curves[name]))
    (picture,) = events.Images("archive")
    assert picture.step == 4
    assert picture.encoded_image_string.startswith(b"\x89PNG")
    (text,) = events.Tensors("spec/text_summary")
    written = text.tensor_proto.string_val[0].decode()
    assert json.loads(written.strip("`json\n"))["world"]["width"] == 24
    assert (folder / "run.h5").read_bytes() == path.read_bytes()
    assert json.loads((folder / "run.best.json").read_bytes())["sha256"]


@pytest.mark.filterwarnings("ignore")
def test_steps_after_a_crash_take_the_place_of_the_lost_ones(attempts, tmp_path):
    attempts(f"tensorboard:{tmp_path}")
    folder, events = read(tmp_path)
    assert folder.name == "run-1"
    found = [(one.step, one.value) for one in events.Scalars("qd_score")]
    before, after = [(s, s) for s in range(1, 5)], [(s, s + 0.5) for s in range(5, 9)]
    assert found == before + after
    assert [one.step for one in events.Tensors("spec/text_summary")] == [0, 4]
