"""Motions of elites, simulated anew from their creature files."""

from collections.abc import Callable, Sequence
from typing import Any

from ...archive.creature import parse
from ...build import build
from ..replay import record
from ..replay_file import read_replay
from .reading import read
from .sheet import Motion


def documents(data: bytes, cells: Sequence[int]) -> list[dict[str, Any]]:
    """Return the creature files of the elites in some cells of an archive file."""
    experiment = build(read(data).spec)
    state = experiment.restore(data, other_device=True)
    return [experiment.creature(state, int(cell)) for cell in cells]  # pyright: ignore


def motions(
    data: bytes, cells: Sequence[int], tell: Callable[[int], None] = lambda done: None
) -> list[Motion]:
    """Simulate the elites in some cells; `tell` is called with the number done."""
    found = []
    for file in documents(data, cells):
        replay = read_replay(record(parse(file)))
        found.append(Motion(replay.positions, replay.edges))
        tell(len(found))
    return found
