"""Reader of replays (`docs/formats.md`) with NumPy alone."""

import json
import struct
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import prod
from typing import Any

import numpy as np

REPLAY_VERSION = 2
"""The worker records a stored replay of an earlier version again."""
REPLAY_FORMAT = f"microcosmos-replay/{REPLAY_VERSION}"


class ReplayError(ValueError):
    """Bytes that are no replay: `field`, what it `needed` and what it `got`."""

    def __init__(self, field: str, needed: str, got: object):
        super().__init__(f"`{field}` needs {needed}; got {got!r:.120}")
        self.field, self.needed, self.got = field, needed, got


@dataclass(frozen=True, eq=False)
class Drive:
    """The drive of a body, and more of the fluid around it."""

    angles: np.ndarray
    """(frame, joint): rest angles of the step before the frame, in rad."""

    lengths: np.ndarray
    """(frame, edge): rest lengths likewise, in cells."""

    velocity: np.ndarray
    """(frame, 2, x, y) of the fluid, in cells a step."""

    energy: np.ndarray
    """(plane, x, y): one plane a frame, one for all if nothing changes it, or none."""


@dataclass(frozen=True, eq=False)
class Replay:
    """The recorded motion of a creature, and the vorticity of the fluid around it."""

    header: dict[str, Any]
    positions: np.ndarray
    """(frame, node, 2), unwrapped, in cells."""

    levels: np.ndarray
    """(frame, x, y) int8: the vorticity in units of `quantum`."""

    drive: Drive | None = None
    """Drive of the body; None if only the motion is known."""

    @property
    def frames(self) -> int:
        return len(self.positions)

    @property
    def size(self) -> tuple[int, int]:
        """Return the cells along x and y."""
        width, height = self.header["size"]
        return width, height

    @property
    def quantum(self) -> float:
        """Return the vorticity of one level, in 1/step."""
        return self.header["vorticity"]["scale"] / 127

    @property
    def vorticity(self) -> np.ndarray:
        """Return the vorticity (frame, x, y) in 1/step."""
        return self.levels * np.float32(self.quantum)

    @cached_property
    def edges(self) -> np.ndarray:
        """Return the nodes (edge, 2) of each edge."""
        return np.array(self.header["edges"], int).reshape(-1, 2)

    @cached_property
    def centres(self) -> np.ndarray:
        """Return the mean position (frame, creature, 2) of each creature's nodes, in cells."""
        member = np.array(self.header.get("member", [0] * self.header["nodes"]))
        count = np.bincount(member)
        sums = np.zeros((len(count), self.frames, 2))
        np.add.at(sums, member, self.positions.swapaxes(0, 1))
        return sums.swapaxes(0, 1) / count[:, None]

    @cached_property
    def solid(self) -> np.ndarray:
        """Return the mask (x, y) of cells without fluid."""
        runs = self.header.get("solid", [prod(self.size)])
        return np.repeat(np.arange(len(runs)) % 2 == 1, runs).reshape(self.size)

    @cached_property
    def strongest(self) -> float:
        """Return the vorticity that 1 % of the nonzero values exceed."""
        # Counts of 256 levels, in place of a sort of millions of values.
        counts = np.bincount(self.levels.ravel().view(np.uint8), minlength=256)
        values = np.arange(256, dtype=np.uint8).view(np.int8).astype(int)
        tally = np.bincount(np.abs(values), counts)
        reaching = np.cumsum(tally[::-1])[::-1]
        strong = np.flatnonzero(reaching > reaching[1] / 100)
        return self.quantum * max(1, strong.max(initial=1))

    def step(self, number: int) -> int:
        """Return the number of steps before a frame."""
        return number * self.header["every"]


def read_replay(data: bytes) -> Replay:
    """Return the replay in these bytes. Raises `ReplayError` if they are invalid."""
    header, start = _header(data)
    frames, nodes, (width, height) = (header[key] for key in ("frames", "nodes", "size"))
    edges, joints = len(header["edges"]), len(header["joints"])
    planes = int(header["energy"]["frames"])
    shapes: list[tuple[tuple[int, ...], Any]] = [
        ((frames, nodes, 2), "<f4"),
        ((frames, joints), "<f4"),
        ((frames, edges), "<f4"),
        ((frames, width, height), np.int8),
        ((frames, 2, width, height), np.int8),
        ((planes, width, height), np.uint8),
    ]
    end = start + sum(np.dtype(kind).itemsize * prod(shape) for shape, kind in shapes)
    _need(len(data) == end, "bytes", f"{end} of them by its header", len(data))
    arrays = []
    for shape, kind in shapes:
        array = np.frombuffer(data, kind, prod(shape), start).reshape(shape)
        # The file is little-endian; an array has the byte order of the machine.
        arrays.append(array.astype(np.float32) if kind == "<f4" else array)
        start += array.nbytes
    valid = all(np.isfinite(array).all() for array in arrays)
    _need(valid, "positions", "finite numbers", "others")
    positions, angles, lengths, levels, velocity, energy = arrays
    speed, most = (header[name]["scale"] for name in ("velocity", "energy"))
    flow = velocity * np.float32(speed / 127), energy * np.float32(most / 255)
    return Replay(header, positions, levels, Drive(angles, lengths, *flow))


def read_motion(part: Callable[[int, int], bytes]) -> Replay:
    """Return a replay without its drive, of which `part` reads bytes from a start to a stop.

    Drive and flow are most of a file, and pages without a server show neither.
    """
    (length,) = struct.unpack("<I", part(0, 4))
    header, start = _header(part(0, 4 + length))
    frames, nodes, size = (header[name] for name in ("frames", "nodes", "size"))
    positions = np.frombuffer(part(start, start + 8 * frames * nodes), "<f4")
    start += 4 * frames * (2 * nodes + len(header["joints"]) + len(header["edges"]))
    levels = np.frombuffer(part(start, start + frames * prod(size)), np.int8)
    return Replay(header, positions.reshape(frames, nodes, 2), levels.reshape(frames, *size))


def _header(data: bytes) -> tuple[dict[str, Any], int]:
    _need(len(data) >= 4, "bytes", "at least 4 of them", len(data))
    (length,) = struct.unpack_from("<I", data)
    _need(4 + length <= len(data), "header", f"{length} bytes", len(data) - 4)
    try:
        header = json.loads(data[4 : 4 + length])
    except ValueError:
        raise ReplayError("header", "JSON", data[4 : 4 + length]) from None
    _need(isinstance(header, dict), "header", "a JSON object", header)
    form = header.get("format")
    _need(form == REPLAY_FORMAT, "format", repr(REPLAY_FORMAT), form)
    _check(header)
    return header, 4 + length


def _check(header: dict[str, Any]) -> None:
    for field in ("frames", "every", "nodes"):
        _need(_is_count(header.get(field)), field, "a whole number from 1", header.get(field))
    size: Any = header.get("size")
    _need(_is_pair(size, _is_count), "size", "width and height", size)
    _check_pairs(header, "edges", header["nodes"])
    _check_pairs(header, "joints", len(header["edges"]))
    for field in ("vorticity", "velocity", "energy"):
        plane: Any = header.get(field)
        _need(isinstance(plane, dict), field, "an object with its scale", plane)
        scale = plane.get("scale")
        valid = isinstance(scale, int | float) and 0 < scale < float("inf")
        _need(valid, f"{field}.scale", "a positive number", scale)
    planes, frames = header["energy"].get("frames"), header["frames"]
    _need(planes in (0, 1, frames), "energy.frames", f"0, 1 or {frames}", planes)
    if "member" in header:
        _check_member(header["member"], header["nodes"])
    if "solid" in header:
        _check_solid(header["solid"], prod(size))


def _check_pairs(header: dict[str, Any], field: str, count: int) -> None:
    pairs: Any = header.get(field)
    needed = f"a list of pairs of numbers below {count}"
    _need(isinstance(pairs, list), field, needed, pairs)
    for pair in pairs:
        _need(_is_pair(pair, lambda k: type(k) is int and 0 <= k < count), field, needed, pair)


def _check_member(member: Any, nodes: int) -> None:
    needed = f"the creature of each of {nodes} nodes, counted from 0"
    _need(isinstance(member, list) and len(member) == nodes, "member", needed, member)
    whole = all(type(k) is int for k in member)
    _need(whole and set(member) == set(range(len(set(member)))), "member", needed, member)


def _check_solid(runs: Any, cells: int) -> None:
    needed = f"lengths of runs that sum to {cells} cells"
    _need(isinstance(runs, list), "solid", needed, runs)
    whole = all(type(k) is int and k >= 0 for k in runs)
    _need(whole and sum(runs) == cells, "solid", needed, runs)


def _is_count(value: Any) -> bool:
    # To Python, `True` is an int too.
    return type(value) is int and value >= 1


def _is_pair(value: Any, valid: Callable[[Any], bool]) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(map(valid, value))


def _need(valid: bool, field: str, needed: str, got: object) -> None:
    if not valid:
        raise ReplayError(field, needed, got)
