"""Pose streams as bytes, as columns of an archive file, and as tables."""

import csv
import json
import re
from dataclasses import fields, replace
from io import BytesIO, StringIO
from pathlib import Path

import numpy as np
import pytest

from microcosmos.archive.poses import (
    FRAMES,
    MOMENTS,
    PoseStream,
    columns,
    decode,
    quantised,
    streams,
)

pytestmark = pytest.mark.fast

DOCUMENT = Path(__file__).parents[3] / "docs" / "formats.md"
SPEC = '{"task": {"steps": 900}, "world": {"width": 48, "height": 40}}'


def stream(nodes=5, seed=0, **changes):
    random = np.random.default_rng(seed)
    positions, middles, scale = quantised(20 + random.normal(size=(FRAMES, nodes, 2)))
    edges = np.stack([np.arange(nodes - 1), np.arange(1, nodes)], 1)
    made = PoseStream(
        positions=positions,
        path=random.normal(size=(MOMENTS, 2)).astype(np.float32),
        middles=middles,
        scale=float(np.float32(scale)),
        edges=edges,
        start=500,
        stop=900,
        strokes=2,
        steps=900,
        size=(48, 40),
        length=nodes - 1.0,
        creature=f"{seed:064x}",
    )
    return replace(made, **changes)


def equal(a, b):
    return all(np.array_equal(getattr(a, f.name), getattr(b, f.name)) for f in fields(a))


def test_a_stream_returns_from_its_bytes():
    assert equal(decode(stream().encode()), stream())


@pytest.mark.parametrize(
    ("damage", "named"),
    [
        (lambda data: data[:-1], "needs"),
        (lambda data: data + b"\0", "needs"),
        (lambda data: b"", "header"),
        (lambda data: b"\xff\xff\xff\xff" + data[4:], "header"),
        (lambda data: data.replace(b"poses/1", b"poses/9"), "format"),
        (lambda data: data.replace(b'"frames"', b'"Frames"'), "whole header; KeyError"),
        (lambda data: data.replace(b'"nodes": 5', b'"nodes":{}'), "whole header; TypeError"),
    ],
)
def test_other_bytes_are_refused(damage, named):
    with pytest.raises(ValueError, match=named):
        decode(damage(stream().encode()))


def test_quantised_positions_are_within_half_a_unit():
    positions = np.random.default_rng(0).uniform(-300, 700, (FRAMES, 9, 2))
    units, middles, scale = quantised(positions)
    assert np.abs(middles[:, None] + scale * units - positions).max() < 0.51 * scale
    assert scale == pytest.approx(np.ptp(positions, 1).max() / 2 / 32767, rel=1e-6)
    far = positions / 100 + 50_000 * np.arange(FRAMES)[:, None, None] / FRAMES
    units, middles, scale = quantised(far)
    assert np.abs(middles[:, None] + scale * units - far).max() < 0.005, "as float32 holds it"
    still = np.full((FRAMES, 2, 2), 3.0)
    units, middles, scale = quantised(still)
    np.testing.assert_array_equal(middles[:, None] + scale * units, still)


@pytest.mark.parametrize("sizes", [(5, 5, 5), (5, 2, 9), ()])
def test_streams_return_from_the_columns_of_an_archive(sizes):
    given = [stream(nodes, seed) for seed, nodes in enumerate(sizes)]
    names = [np.frombuffer(bytes.fromhex(one.creature), np.uint8) for one in given]
    tree = {"archive": {"poses": columns(given), "creature": names}}
    found = streams(tree, {"spec": SPEC})
    assert all(equal(a, b) for a, b in zip(found, given, strict=True))
    for outside in (-1, 5) if sizes else ():
        tree["archive"]["poses"]["edges"][0, 0, 1] = outside
        with pytest.raises(ValueError, match=f"must connect nodes of the body; got {outside}"):
            streams(tree, {"spec": SPEC})


def test_exports_are_in_steps_and_cells():
    one = stream()
    rows = list(csv.reader(StringIO(one.csv())))
    assert rows[0] == ["step", "node", "x", "y"]
    assert len(rows) == 1 + FRAMES * 5
    step, node, x, y = map(float, rows[-1])
    assert (step, node) == (900, 4)
    assert (x, y) == pytest.approx(tuple(one.cells[-1, -1]), abs=1e-4)
    with np.load(BytesIO(one.npz())) as found:
        np.testing.assert_array_equal(found["positions"], one.cells)
        np.testing.assert_array_equal(found["times"], one.times)
        np.testing.assert_array_equal(found["edges"], one.edges)
    assert one.npz() == one.npz()


def test_the_example_in_the_documents_reads_a_stream(tmp_path, monkeypatch):
    (tmp_path / "creature.poses").write_bytes(stream().encode())
    monkeypatch.chdir(tmp_path)
    section = DOCUMENT.read_text().partition("## Pose stream\n")[2]
    (example,) = re.findall("```python\n(.*?)```", section.partition("\n## ")[0], re.DOTALL)
    names = {"json": json, "np": np, "Path": Path}
    exec(example, names)
    np.testing.assert_allclose(names["cells"], stream().cells, rtol=1e-5)
    np.testing.assert_array_equal(names["path"], stream().path)
