"""A creature file with the files of its ancestors in the field `ancestors`."""

from collections.abc import Iterable, Mapping
from typing import Any

from .creature import CreatureError, alone, check

MAX_ANCESTORS = 200
"""Maximum number of ancestors in one document."""


def document(file: Mapping[str, Any], ancestors: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """Return a creature file with the files of its ancestors, nearest first."""
    return {**file, "ancestors": [dict(one) for one in ancestors]}


def split(data: Mapping[str, Any]) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Return a creature file and those of its ancestors, each checked with its hash.

    Raises `CreatureError` if one is invalid, or is not an ancestor.
    """
    files = data.get("ancestors", [])
    if not isinstance(files, list) or len(files) > MAX_ANCESTORS:
        got = len(files) if isinstance(files, list) else files
        needed = f"a list of at most {MAX_ANCESTORS} creature files"
        raise CreatureError("ancestors", needed, got)
    file = check(alone(data))
    ancestors = [_ancestor(one, place) for place, one in enumerate(files)]
    _refuse_unrelated(file, ancestors)
    return file, ancestors


def _ancestor(data: Any, place: int) -> dict[str, Any]:
    try:
        return check(data)  # It has no `ancestors` of its own.
    except CreatureError as error:
        field = f"ancestors.{place}.{error.field}"
        raise CreatureError(field, error.needed or "", error.got, error.reason) from error


def parents(file: Mapping[str, Any]) -> list[str]:
    """Return the names of a creature's parents in its file."""
    return list((file["provenance"] or {}).get("parents", ()))


def _refuse_unrelated(file: Mapping[str, Any], ancestors: list[dict[str, Any]]) -> None:
    by_name = {one["sha256"]: one for one in ancestors}
    known, nearest = {file["sha256"]}, parents(file)
    while nearest:
        met = [name for name in nearest if name in by_name and name not in known]
        known.update(met)
        nearest = [parent for name in met for parent in parents(by_name[name])]
    for place, one in enumerate(ancestors):
        if one["sha256"] not in known or one["sha256"] == file["sha256"]:
            needed = f"an ancestor of {file['sha256']}"
            raise CreatureError(f"ancestors.{place}", needed, one["sha256"])
