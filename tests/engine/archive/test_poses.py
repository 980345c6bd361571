"""Pose streams: the file, and its description in the documents."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from reports import pose_stream

from microcosmos.archive.poses import decode

DOCUMENT = Path(__file__).parents[3] / "docs" / "formats.md"


def test_a_stream_is_read_as_it_was_written():
    data = pose_stream("ab" * 32)
    found = decode(data)
    assert found.encode() == data
    assert (found.creature, found.times[-1], len(found.times)) == ("ab" * 32, 120, 64)
    x, y = found.cells[-1].T
    np.testing.assert_allclose(x, [60, 61, 62], atol=1e-3)
    np.testing.assert_allclose(y, 30 + np.sin(-2 * np.pi * np.arange(3) / 3), atol=1e-3)


def test_the_example_in_the_documents_reads_a_stream(tmp_path, monkeypatch):
    data = pose_stream("ab" * 32)
    (tmp_path / "creature.poses").write_bytes(data)
    monkeypatch.chdir(tmp_path)
    section = DOCUMENT.read_text().partition("## Pose stream\n")[2]
    (example,) = re.findall("```python\n(.*?)```", section.partition("\n## ")[0], re.DOTALL)
    names = {"json": json, "np": np, "Path": Path}
    exec(example, names)
    np.testing.assert_allclose(names["cells"], decode(data).cells, rtol=1e-6)
    np.testing.assert_array_equal(names["path"], decode(data).path)


@pytest.mark.parametrize("data", [b"", b"\x02\0\0\0{}", pose_stream("ab" * 32)[:-1]])
def test_other_bytes_are_refused(data):
    with pytest.raises(ValueError, match="pose stream"):
        decode(data)
