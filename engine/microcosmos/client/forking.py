"""What a new run begins with, as the API asks for it."""

from collections.abc import Mapping, Sequence
from typing import Any

from .creature import Creature


def document(
    creatures: Sequence[str | Creature] | None,
    cells: Sequence[int] | None,
    region: Mapping[str, Sequence[float]] | None,
    generation: int | None,
    spec: Mapping[str, Any] | None,
    name: str | None,
) -> dict[str, Any]:
    """Raises `ValueError` where elites are chosen in two ways; in none, they are all."""
    chosen: dict[str, Any] = {}
    if creatures is not None:
        chosen["creatures"] = [
            one.sha if isinstance(one, Creature) else one for one in creatures
        ]
    if cells is not None:
        chosen["cells"] = list(cells)
    if region is not None:
        chosen["region"] = {axis: list(ends) for axis, ends in region.items()}
    if len(chosen) > 1:
        raise ValueError(f"fork needs one of creatures, cells, region; got {', '.join(chosen)}")
    asked: dict[str, Any] = {"from": chosen or {"archive": True}, "spec": dict(spec or {})}
    if generation is not None:
        asked["generation"] = generation
    if name:
        asked["name"] = name
    return asked
