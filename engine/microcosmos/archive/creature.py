"""Creature files as JSON: parse one, and the functions that name, build and interpret it."""

from collections.abc import Mapping
from typing import Any

from ..invalid import InvalidField
from ..json_text import read_json

# Callers find these beside `parse`, as docs/formats.md shows.
from ..naming import canonical, document, name  # noqa: F401
from ..spec.creature import (  # noqa: F401
    CreatureError,
    Identity,
    alone,
    check,
    room,
    scene_of,
)


def parse(data: Any) -> dict[str, Any]:
    """Check a creature file, JSON or decoded: its genes, its world and its hash.

    The files of its ancestors are left out: `pedigree.split` reads them. Raises
    `CreatureError`, which names the field, what was needed and what came.
    """
    if isinstance(data, str | bytes):
        data = decoded(data)
    return check(alone(data) if isinstance(data, Mapping) else data)


def decoded(data: str | bytes) -> Any:
    """Return the document of a file in JSON; raise `CreatureError` if it is none."""
    try:
        return read_json(data)
    except InvalidField as error:
        raise CreatureError(error.field, "one value", "two", error.reason) from None
    except ValueError as error:
        raise CreatureError("file", f"JSON ({error})", data[:60]) from error
