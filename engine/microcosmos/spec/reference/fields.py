"""Fields of specs as people read them, taken from the JSON schemas."""

from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

from ..experiments import EXPERIMENTS
from .words import TAGS, Schema, default, inner_of, is_list, kind, range_of, refs, text_of, unit


class Field(NamedTuple):
    """One row of the reference."""

    name: str
    kind: str
    unit: str
    range: str
    default: str
    text: str
    source: str


class Part(NamedTuple):
    """A part of specs, with the paths at which it stands."""

    name: str
    text: str
    source: str
    fields: tuple[Field, ...]
    paths: tuple[str, ...] = ()


def experiment(name: str) -> Part:
    """Return an experiment as a part."""
    schema = _schemas()[name]
    return _part(name, schema, schema.get("$defs", {}))


def parts() -> tuple[Part, ...]:
    """Return every part of every experiment, by name."""
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
    """Yield the path and the name of every part below a schema."""
    for name, field in schema.get("properties", {}).items():
        for part in refs(field):
            path = f"{way}{name}" + ("[]" if is_list(field) else "")
            yield path, part
            yield from _walk(defined[part], defined, f"{path}.")


def _part(name: str, schema: Schema, defined: Schema, paths: tuple[str, ...] = ()) -> Part:
    needed = schema.get("required", [])
    fields = schema["properties"].items()
    rows = tuple(_field(key, field, defined, key in needed) for key, field in fields)
    return Part(name, text_of(schema), schema.get("source", ""), rows, paths)


def _field(name: str, field: Schema, defined: Schema, required: bool) -> Field:
    inner = inner_of(field)
    parts = refs(field)
    text = text_of(field)
    if not text and len(parts) == 1:
        text = text_of(defined[parts[0]])
    if not text and name in TAGS and "const" in field:
        text = f"Selects this {name}."
    return Field(
        name=name,
        kind=kind(field),
        unit=unit(field, inner),
        range=range_of(inner, field),
        default=default(field, defined, required),
        text=text,
        source=field.get("source", ""),
    )
