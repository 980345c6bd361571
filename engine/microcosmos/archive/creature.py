"""Creature files as JSON: parse one, and the functions that name, build and interpret it."""

import json
from typing import Any

# Callers find these beside `parse`, as docs/formats.md shows.
from ..naming import canonical, document, name  # noqa: F401
from ..spec.creature import CreatureError, Identity, check, room, scene_of  # noqa: F401


def parse(data: Any) -> dict[str, Any]:
    """Check a creature file, JSON or decoded: its genes, its world and its hash.

    Raises `CreatureError`, which names the field, what was needed and what came.
    """
    if isinstance(data, str | bytes):
        try:
            data = json.loads(data)
        except (ValueError, RecursionError) as error:
            raise CreatureError("file", f"JSON ({error})", data[:60]) from error
    return check(data)
