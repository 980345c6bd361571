"""How elites of an archive move: their creature files, simulated anew."""

from collections.abc import Callable, Sequence
from typing import Any

from ...archive.creature import parse
from ...build import build
from ..replay import record
from ..replay_file import read_replay
from .reading import read
from .sheet import Motion


def documents(data: bytes, cells: Sequence[int]) -> list[dict[str, Any]]:
    """The creature files of the elites in some cells of an archive file."""
    experiment = build(read(data).spec)
    state = experiment.restore(data, other_device=True)
    return [experiment.creature(state, int(cell)) for cell in cells]  # pyright: ignore


def motions(
    data: bytes, cells: Sequence[int], tell: Callable[[int], None] = lambda done: None
) -> list[Motion]:
    """The elites in some cells, each simulated once; `tell` hears how many are done."""
    found = []
    for file in documents(data, cells):
        replay = read_replay(record(parse(file)))
        found.append(Motion(replay.positions, replay.edges))
        tell(len(found))
    return found
