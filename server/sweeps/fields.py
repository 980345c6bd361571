"""Fields of a spec by their dotted paths, and what they can be given."""

from collections.abc import Iterator, Sequence
from difflib import get_close_matches
from typing import Any

LIKE = 0.4
"""How much a path must be like another one to be proposed for it."""


def exists(document: Any, path: str) -> bool:
    """Whether a path leads to a field; into a part that is null, only a spec can say."""
    return _leads(document, path.split("."))


def _leads(part: Any, names: Sequence[str]) -> bool:
    if part is None or not names:
        return True
    name, *rest = names
    if isinstance(part, dict):
        return name in part and _leads(part[name], rest)
    return _counts(name, part) and _leads(part[int(name)], rest)


def _counts(name: str, part: Any) -> bool:
    """Whether a name is the number of something in a list."""
    whole = isinstance(part, list) and name.isascii() and name.isdecimal() and len(name) < 6
    return whole and int(name) < len(part)


def replaced(document: Any, path: str, value: Any) -> Any:
    """The document with another value at a path; what was null there becomes a part."""
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
    """All paths of a document: of its parts, its lists, and what is in them."""
    items = document.items() if isinstance(document, dict) else enumerate(document)
    for name, value in items:
        path = f"{before}{name}"
        yield path
        if isinstance(value, dict | list):
            yield from paths(value, f"{path}.")


def nearest(document: Any, path: str) -> str | None:
    """The path that somebody may have meant."""
    known = list(paths(document))
    ending = [each for each in known if each.endswith(f".{path}")]
    return next(iter(ending or get_close_matches(path, known, 1, LIKE)), None)


def inside(path: str, other: str) -> bool:
    """Whether a path leads into what another one replaces."""
    return f"{path}.".startswith(f"{other}.")
