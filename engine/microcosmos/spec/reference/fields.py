"""Fields of specs as people read them, taken from the JSON schemas."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

from ..experiments import EXPERIMENTS
from .words import TAGS, Schema, default, items, kind, line, plain, range_of, refs, unit


@dataclass(frozen=True)
class Field:
    """One row of the reference."""

    name: str
    kind: str
    unit: str
    range: str
    default: str
    text: str
    source: str


@dataclass(frozen=True)
class Part:
    """A part of specs, and at which paths it stands."""

    name: str
    text: str
    source: str
    fields: tuple[Field, ...]
    paths: tuple[str, ...] = ()


def experiment(name: str) -> Part:
    """An experiment's own fields."""
    schema = _schemas()[name]
    return _part(name, schema, schema.get("$defs", {}))


def parts() -> tuple[Part, ...]:
    """Every part of every experiment, by name."""
    defined: Schema = {}
    paths: dict[str, list[str]] = {}
    for schema in _schemas().values():
        defined |= schema.get("$defs", {})
        for path, part in _walk(schema, schema.get("$defs", {})):
            paths.setdefault(part, []).append(path)
    return tuple(
        _part(name, defined[name], defined, tuple(dict.fromkeys(paths[name])))
        for name in sorted(paths)
    )


@lru_cache
def _schemas() -> dict[str, Schema]:
    return {name: one.spec.model_json_schema() for name, one in EXPERIMENTS.items()}


def _walk(schema: Schema, defined: Schema, way: str = "") -> Iterator[tuple[str, str]]:
    """(path, part) of every part below a schema."""
    for name, field in schema.get("properties", {}).items():
        for part in refs(field):
            path = f"{way}{name}" + ("[]" if items(field) else "")
            yield path, part
            yield from _walk(defined[part], defined, f"{path}.")


def _part(name: str, schema: Schema, defined: Schema, paths: tuple[str, ...] = ()) -> Part:
    needed = schema.get("required", [])
    own = schema["properties"].items()
    rows = tuple(_field(key, field, defined, key in needed) for key, field in own)
    text = line(schema.get("description", ""))
    return Part(name, text, schema.get("source", ""), rows, paths)


def _field(name: str, field: Schema, defined: Schema, required: bool) -> Field:
    inner = plain(field)
    parts = refs(field)
    text = line(field.get("description", ""))
    if not text and len(parts) == 1:
        text = line(defined[parts[0]].get("description", ""))
    if not text and name in TAGS and "const" in field:
        text = "Says which part this is."
    return Field(
        name=name,
        kind=kind(field),
        unit=unit(field, inner),
        range=range_of(inner, field),
        default=default(field, defined, required),
        text=text,
        source=field.get("source", ""),
    )
