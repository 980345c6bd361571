"""Fields of a spec by dotted path: test, replace, find the nearest, combine and compare."""

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


IGNORED = ("seed",)
"""Fields that may differ within a group of runs."""

KINDS = ("builder", "encoding", "kind", "operator")
"""Fields that decide which other fields their part has."""

MAX_FIELDS = 3
"""Maximum number of fields in a label."""


def flattened(document: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield every value of a spec with its dotted path."""
    if isinstance(document, Sequence) and any(isinstance(x, Mapping) for x in document):
        document = dict(enumerate(document))
    if not isinstance(document, Mapping):
        yield path, document
        return
    for name, part in document.items():
        yield from flattened(part, f"{path}.{name}" if path else str(name))


def is_none(value: Any) -> bool:
    """Return whether a value stands for an absent part: null, or a list without entries."""
    return value in (None, [], ())


def differing(flats: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the paths whose values differ; an absent field is none.

    Fields that only one kind of a part has are left out where the kind differs too, unless
    their values differ within the kind.
    """
    paths = dict.fromkeys(path for flat in flats for path in flat if path not in IGNORED)
    values = {path: [key(flat.get(path)) for flat in flats] for path in paths}
    differ = {path: own for path, own in values.items() if len(set(own)) > 1}
    everywhere = {path for path in differ if all(path in flat for flat in flats)}
    return [p for p in differ if p in everywhere or not _follows(p, differ)]


def key(value: Any) -> str:
    """Return text that is equal for equal values of a field."""
    return "none" if is_none(value) else repr(value)


def _follows(path: str, differ: Mapping[str, Sequence[str]]) -> bool:
    """Return whether the kind of a field's part, which differs too, decides its value."""
    part, _, name = path.rpartition(".")
    kinds = [differ[kind] for one in KINDS if (kind := f"{part}.{one}") in differ]
    return name not in KINDS and any(
        len(set(zip(kind, differ[path], strict=True))) == len(set(kind)) for kind in kinds
    )


def label(flat: Mapping[str, Any], paths: Sequence[str]) -> str:
    """Return the values of the first paths, as `world viscosity 0.05`."""
    parts = [f"{short(path)} {value_text(flat.get(path))}" for path in paths[:MAX_FIELDS]]
    return ", ".join(parts) + (" …" if len(paths) > MAX_FIELDS else "")


def short(path: str) -> str:
    """Return the last two words of a path, without indices."""
    words = [word for word in path.split(".") if not word.isdigit()]
    return " ".join(words[-2:]).replace("_", " ")


def number_text(value: float) -> str:
    """Return the shortest text from four digits on that is read as the same number."""
    texts = (f"{value:.{digits}g}" for digits in range(4, 18))
    return next((text for text in texts if float(text) == value), str(value))


def value_text(value: Any) -> str:
    """Return a value of a spec as short text; long lists are cut."""
    text = _whole_text(value)
    is_list = isinstance(value, Sequence) and not isinstance(value, str)
    return text[:39] + "…" if is_list and len(text) > 40 else text


def value_texts(values: Sequence[Any]) -> list[str]:
    """Return values of a field as text; lists whose first entries are equal stand whole."""
    texts = list(map(value_text, values))
    if len(set(texts)) == len(set(map(key, values))):
        return texts
    return list(map(_whole_text, values))


def _whole_text(value: Any) -> str:
    if is_none(value):
        return "none"
    if isinstance(value, float):
        return number_text(value)
    if isinstance(value, Sequence) and not isinstance(value, str):
        return ", ".join(map(_whole_text, value))
    return str(value)
