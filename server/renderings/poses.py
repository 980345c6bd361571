"""Pose streams of creatures: as stored, or made from the positions of a replay."""

import json
import struct

import numpy as np
from sqlalchemy.orm import Session

from microcosmos.archive import poses
from microcosmos.bodies import extent, from_edges

from ..services.services import Services
from ..storage.artifacts import Artifacts
from ..tables import REPLAY, Artifact, Creature
from . import storage

LENGTH = struct.Struct("<I")


def find(session: Session, services: Services, row: Creature) -> bytes | None:
    """Return the pose stream; None without a stored one and without a replay."""
    if row.poses is not None:
        return row.poses
    replay = storage.find(session, row.sha256, REPLAY)
    return from_replay(services.artifacts, replay, row.sha256) if replay else None


def from_replay(artifacts: Artifacts, replay: Artifact, creature: str) -> bytes:
    """Return a pose stream with every k-th frame of the whole replay; it spans no strokes."""
    (length,) = LENGTH.unpack(_part(artifacts, replay, 0, LENGTH.size))
    start = LENGTH.size + length
    header = json.loads(_part(artifacts, replay, LENGTH.size, start))
    shape = header["frames"], header["nodes"], 2
    data = _part(artifacts, replay, start, start + 4 * np.prod(shape, dtype=int))
    whole = np.frombuffer(data, "<f4").reshape(shape)
    stride = max(1, -(-(len(whole) - 1) // poses.FRAMES))
    kept = whole[::stride]
    positions, origin, scale = poses.quantised(kept[1:] if len(kept) > 1 else kept)
    edges = np.array(header["edges"], int).reshape(-1, 2)
    return poses.PoseStream(
        positions=positions,
        path=kept.mean(1),
        origin=origin,
        scale=scale,
        edges=edges,
        start=0,
        stop=header["every"] * stride * (len(kept) - 1),
        strokes=0,
        steps=header["steps"],
        size=tuple(header["size"]),
        length=extent(from_edges(whole[0], edges)),
        creature=creature,
    ).encode()


def _part(artifacts: Artifacts, replay: Artifact, start: int, stop: int) -> bytes:
    return artifacts.read(replay.path, start, stop)
