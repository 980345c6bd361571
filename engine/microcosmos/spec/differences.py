"""Fields in which specs differ, and labels that state them."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

IGNORED = ("seed",)
"""Fields that may differ within a group of runs."""

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


def differing(flats: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the paths whose values differ; only those that all specs have, if any."""
    paths = list(dict.fromkeys(path for flat in flats for path in flat if path not in IGNORED))
    other = [p for p in paths if len({repr(flat.get(p, "none")) for flat in flats}) > 1]
    shared = [path for path in other if all(path in flat for flat in flats)]
    return shared or other


def label(flat: Mapping[str, Any], paths: Sequence[str]) -> str:
    """Return the values of the first paths, as `world viscosity 0.05`."""
    parts = [
        f"{short(path)} {value_text(flat.get(path, 'none'))}" for path in paths[:MAX_FIELDS]
    ]
    return ", ".join(parts) + (" …" if len(paths) > MAX_FIELDS else "")


def short(path: str) -> str:
    """Return the last two words of a path, without indices."""
    words = [word for word in path.split(".") if not word.isdigit()]
    return " ".join(words[-2:]).replace("_", " ")


def value_text(value: Any) -> str:
    """Return a value of a spec as short text."""
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, Sequence) and not isinstance(value, str):
        text = ", ".join(map(value_text, value))
        return text if len(text) <= 40 else text[:39] + "…"
    return "none" if value is None else str(value)
