"""Fields of a spec by dotted path: test, replace, find the nearest, and combine values."""

from collections.abc import Iterator, Mapping, Sequence
from difflib import get_close_matches
from itertools import product
from typing import Any

SIMILARITY = 0.4
"""Least similarity of a path that is suggested for another."""


def exists(document: Any, path: str) -> bool:
    """Return whether a path may lead to a field; below null only the spec can decide."""
    return _leads(document, path.split("."))


def _leads(part: Any, names: Sequence[str]) -> bool:
    if part is None or not names:
        return True
    name, *rest = names
    if isinstance(part, dict):
        return name in part and _leads(part[name], rest)
    return _is_index(name, part) and _leads(part[int(name)], rest)


def _is_index(name: str, part: Any) -> bool:
    whole = isinstance(part, list) and name.isascii() and name.isdecimal() and len(name) < 6
    return whole and int(name) < len(part)


def value(document: Any, path: str) -> Any:
    """Return the value at a path of a document that has it."""
    for name in path.split("."):
        document = document[int(name)] if isinstance(document, list) else document[name]
    return document


def replaced(document: Any, path: str, value: Any) -> Any:
    """Return the document with another value at a path; a null on the way becomes a part."""
    return _replaced(document, path.split("."), value)


def _replaced(part: Any, names: Sequence[str], value: Any) -> Any:
    if not names:
        return value
    name, *rest = names
    if isinstance(part, list):
        place = int(name)
        changed = _replaced(part[place], rest, value)
        return [*part[:place], changed, *part[place + 1 :]]
    part = part or {}
    return {**part, name: _replaced(part.get(name), rest, value)}


def paths(document: Any, before: str = "") -> Iterator[str]:
    items = document.items() if isinstance(document, dict) else enumerate(document)
    for name, value in items:
        path = f"{before}{name}"
        yield path
        if isinstance(value, dict | list):
            yield from paths(value, f"{path}.")


def nearest(document: Any, path: str) -> str | None:
    known = list(paths(document))
    ending = [each for each in known if each.endswith(f".{path}")]
    return next(iter(ending or get_close_matches(path, known, 1, SIMILARITY)), None)


def inside(path: str, other: str) -> bool:
    return f"{path}.".startswith(f"{other}.")


def combinations(grid: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    """Return the values of each case of a sweep, the last field fastest."""
    return [dict(zip(grid, values, strict=True)) for values in product(*grid.values())]
