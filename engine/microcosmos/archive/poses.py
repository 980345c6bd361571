"""Pose streams: how a creature moved over its last two strokes, without the fluid.

The layout is described in `docs/formats.md`.
"""

import csv as csv_module
import json
import struct
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO, StringIO
from typing import Any

import numpy as np

from ..invalid import InvalidField

FORMAT = "microcosmos-poses/1"
FRAMES = 64
"""Recorded poses, at equal times: 32 for each of the last two strokes."""
STROKES = 2
"""Strokes that the frames span."""
MOMENTS = 65
"""Recorded places of the centre, at equal times from the start to the end."""
LEVELS = np.iinfo(np.int16).max
_LENGTH = struct.Struct("<I")
_COUNTS = ("start", "stop", "strokes")
_NUMBERS = (*_COUNTS, "steps", "scale", "length")


@dataclass(frozen=True)
class PoseStream:
    """The poses of one creature; places are in cells, not wrapped around the world.

    Nodes are those that have grown, edges pairs of them.
    """

    positions: np.ndarray
    """Offsets of nodes from `middles` in units of `scale`: int16 (frame, node, 2). However far
    a creature goes, a unit is as small as its body lets it be."""
    path: np.ndarray
    """Mean position of nodes at equal times of the whole simulation: float32 (moment, 2)."""
    middles: np.ndarray
    """The middle of the body's extent in each frame: float32 (frame, 2)."""
    scale: float
    """Cells of one unit."""
    edges: np.ndarray
    """Pairs of nodes (edge, 2)."""
    start: int
    """Steps before the first recorded stroke; the last frame is at `stop`."""
    stop: int
    strokes: int
    """Strokes that the frames span: 2, or 0 if the creature did not complete as many."""
    steps: int
    """Steps of the whole simulation."""
    size: tuple[int, int]
    """Size of the world, in cells."""
    length: float
    """Length of the body, in cells."""
    creature: str
    """Its SHA-256."""

    @property
    def cells(self) -> np.ndarray:
        """Positions in cells: float32 (frame, node, 2)."""
        offsets = np.float32(self.scale) * self.positions
        return np.asarray(self.middles, np.float32)[:, None] + offsets

    @property
    def times(self) -> np.ndarray:
        """Steps done at each frame."""
        frames = len(self.positions)
        passed = np.arange(1, frames + 1) * (self.stop - self.start)
        return self.start + (2 * passed + frames) // (2 * frames)

    def encode(self) -> bytes:
        """Return the file: the length of a JSON header, the header, path, middles and
        positions."""
        header = {
            "format": FORMAT,
            "creature": self.creature,
            "frames": len(self.positions),
            "nodes": self.positions.shape[1],
            "moments": len(self.path),
            "edges": np.asarray(self.edges).tolist(),
            "size": [int(x) for x in self.size],
            **{name: getattr(self, name) for name in _NUMBERS},
        }
        text = json.dumps(header).encode()
        text += b" " * (-len(text) % 4)  # Aligned, so that a browser can view numbers in place.
        arrays = [np.asarray(one, "<f4") for one in (self.path, self.middles)]
        arrays.append(np.asarray(self.positions, "<i2"))
        return b"".join((_LENGTH.pack(len(text)), text, *(x.tobytes() for x in arrays)))

    def csv(self) -> str:
        """Return a table of `step`, `node`, `x`, `y`, in steps and cells."""
        text = StringIO()
        writer = csv_module.writer(text, lineterminator="\n")
        writer.writerow(("step", "node", "x", "y"))
        for step, nodes in zip(self.times.tolist(), self.cells.tolist(), strict=True):
            writer.writerows(
                (step, node, f"{x:.4f}", f"{y:.4f}") for node, (x, y) in enumerate(nodes)
            )
        return text.getvalue()

    def npz(self) -> bytes:
        """Return a NumPy file with `positions` in cells, `times` in steps, `path`, `edges`."""
        data = BytesIO()
        np.savez(data, positions=self.cells, times=self.times, path=self.path, edges=self.edges)
        return data.getvalue()


def decode(data: bytes) -> PoseStream:
    """Return the pose stream in a file. Raises `ValueError` for any other bytes."""
    try:
        (length,) = _LENGTH.unpack_from(data)
        header = json.loads(data[_LENGTH.size : _LENGTH.size + length])
    except (struct.error, ValueError) as error:
        raise ValueError(f"a pose stream must start with its header: {error}") from error
    if not isinstance(header, dict) or header.get("format") != FORMAT:
        raise InvalidField("format", f"of a pose stream must be {FORMAT}")
    try:
        return _stream(header, data, _LENGTH.size + length)
    except (KeyError, IndexError, TypeError, OverflowError) as error:
        raise ValueError(f"a pose stream must have a whole header; {error!r}") from error


def _stream(header: Mapping[str, Any], data: bytes, start: int) -> PoseStream:
    frames, nodes, moments = (int(header[name]) for name in ("frames", "nodes", "moments"))
    needed = start + 8 * (moments + frames) + 4 * frames * nodes
    if len(data) != needed:
        raise ValueError(f"the pose stream needs {needed:,} bytes, got {len(data):,}")
    places = np.frombuffer(data, "<f4", 2 * (moments + frames), start).reshape(-1, 2)
    found = np.frombuffer(data, "<i2", offset=start + 8 * (moments + frames))
    return PoseStream(
        positions=found.reshape(frames, nodes, 2),
        path=places[:moments],
        middles=places[moments:],
        edges=np.array(header["edges"], np.int32).reshape(-1, 2),
        size=(header["size"][0], header["size"][1]),
        creature=header["creature"],
        start=header["start"],
        stop=header["stop"],
        strokes=header["strokes"],
        steps=header["steps"],
        scale=header["scale"],
        length=header["length"],
    )


def batch(streams: Iterable[bytes | None]) -> bytes:
    """Return pose streams one after another, each after its length, without absent ones."""
    return b"".join(_LENGTH.pack(len(one)) + one for one in streams if one)


def unbatched(data: bytes) -> list[bytes]:
    """Return the pose streams of a batch. Raise `ValueError` if it ends within one."""
    found, start = [], 0
    while start < len(data):
        begin = start + _LENGTH.size
        stop = begin + (_LENGTH.unpack_from(data, start)[0] if begin <= len(data) else 0)
        if not begin <= stop <= len(data):
            raise ValueError(
                f"a batch of pose streams must have {stop:,} bytes or more, got {len(data):,}"
            )
        found.append(data[begin:stop])
        start = stop
    return found


def quantised(positions: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Return positions (frame, node, 2) as `PoseStream.positions`, its middles and scale."""
    low, high = positions.min(1), positions.max(1)
    middles = ((low + high) / 2).astype(np.float32)
    scale = float(max(np.max(high - low, initial=0) / 2, 1e-6)) / LEVELS
    units = np.clip(np.rint((positions - middles[:, None]) / scale), -LEVELS, LEVELS)
    return units.astype(np.int16), middles, scale


_ROWS = {"scale": "f4", "length": "f4", **dict.fromkeys(_COUNTS, "i4")}
"""Types of the values that are columns as they are."""


def columns(streams: Sequence[PoseStream]) -> dict[str, np.ndarray]:
    """Return streams as the group `archive/poses` of an archive file, a row each.

    Where bodies differ, rows of smaller ones are filled with 0 at the end.
    """
    found = {
        name: np.array([getattr(one, name) for one in streams], kind)
        for name, kind in _ROWS.items()
    }
    nodes = _filled([one.positions.swapaxes(0, 1) for one in streams], (FRAMES, 2), "i2")
    return found | {
        "middles": np.array([one.middles for one in streams], "f4").reshape(-1, FRAMES, 2),
        "nodes": np.array([one.positions.shape[1] for one in streams], "i4"),
        "positions": nodes.swapaxes(1, 2),
        "connected": np.array([len(one.edges) for one in streams], "i4"),
        "edges": _filled([one.edges for one in streams], (2,), "i4"),
        "path": _filled([one.path for one in streams], (2,), "f4"),
    }


def _filled(rows: list[np.ndarray], rest: tuple[int, ...], kind: str) -> np.ndarray:
    """Stack arrays (item, *rest) whose numbers of items may differ."""
    found = np.zeros((len(rows), max(map(len, rows), default=0), *rest), kind)
    for whole, row in zip(found, rows, strict=True):
        whole[: len(row)] = row
    return found


def streams(tree: Mapping[str, Any], attributes: Mapping[str, str]) -> list[PoseStream]:
    """Return the pose streams of the elites in an archive file, as `file.load` returns it.

    Raises `ValueError` where edges connect nodes that there are not.
    """
    archive, spec = tree["archive"], json.loads(attributes["spec"])
    kept, world = archive["poses"], spec["world"]
    nodes = np.minimum(kept["nodes"], kept["positions"].shape[2])
    outside = (kept["edges"] < 0) | (kept["edges"] >= nodes[:, None, None])
    if outside.any():
        got = kept["edges"][outside][0]
        raise InvalidField("archive/poses/edges", f"must connect nodes of the body; got {got}")
    return [
        PoseStream(
            positions=kept["positions"][i, :, : kept["nodes"][i]],
            path=kept["path"][i],
            middles=kept["middles"][i],
            edges=kept["edges"][i, : kept["connected"][i]],
            steps=spec["task"]["steps"],
            size=(world["width"], world["height"]),
            creature=bytes(creature).hex(),
            **{name: kept[name][i].item() for name in ("scale", "length", *_COUNTS)},
        )
        for i, creature in enumerate(archive["creature"])
    ]
