"""Motions of elites, simulated anew from their creature files."""

from collections.abc import Callable, Mapping, Sequence

from ...build import build
from ...experiments.evolution import Evolution
from ..replay import record
from ..replay_file import read_replay
from .reading import read
from .sheet import Motion


def motions(
    data: bytes,
    cells: Sequence[int],
    trusted: Mapping[str, bool] | None = None,
    tell: Callable[[int], None] = lambda done: None,
) -> list[Motion]:
    """Simulate the elites in some cells; `tell` is called with the number done.

    `trusted` holds the verdicts of audits by creature.
    """
    experiment, found = build(read(data).spec), []
    assert isinstance(experiment, Evolution)
    state = experiment.restore(data, other_device=True)
    for cell in cells:
        replay = read_replay(record(experiment.creature(state, int(cell))))
        verdict = (trusted or {}).get(replay.header["creature"])
        found.append(Motion(replay.positions, replay.edges, verdict))
        tell(len(found))
    return found
