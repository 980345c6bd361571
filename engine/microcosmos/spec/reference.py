"""The reference of every field of a spec, from the JSON schemas: types, ranges, defaults.

`python -m microcosmos.spec.reference > docs/spec.md` writes it.
"""

import sys
from collections.abc import Iterator
from functools import lru_cache
from typing import Any, NamedTuple

from ..measures import NAMED, RECORDED
from .experiments import EXPERIMENTS, Experiment

Schema = dict[str, Any]

MAX_LENGTH = 60
"""Maximum length of a written-out default."""

MEASURES = RECORDED + NAMED
"""A choice that has a page of its own."""
TYPES = {"integer": "integer", "number": "number", "boolean": "yes or no", "string": "text"}
TAGS = ("experiment", "builder", "encoding", "operator", "kind")
"""Fields whose one value says which part it is."""


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


def inner_of(field: Schema) -> Schema:
    """Return the inner schema: x of `x | None`, and the entry of a list."""
    options = [o for o in field.get("anyOf", [field]) if o.get("type") != "null"]
    inner = options[0] if len(options) == 1 else field
    items = inner.get("items")
    return items if isinstance(items, dict) and "prefixItems" not in inner else inner


def is_list(field: Schema) -> bool:
    return any("items" in o for o in [field, *field.get("anyOf", [])])


def refs(field: Schema) -> list[str]:
    """Return the names of the parts that a field may hold."""
    if "$ref" in field:
        return [field["$ref"].rpartition("/")[2]]
    inner = [*field.get("anyOf", []), *field.get("oneOf", [])]
    if isinstance(field.get("items"), dict):
        inner.append(field["items"])
    return list(dict.fromkeys(name for one in inner for name in refs(one)))


def kind(field: Schema) -> str:
    if names := refs(field):
        links = " or ".join(f"[{ref}](#{ref.lower()})" for ref in names)
        text = f"list of {links}" if is_list(field) else links
    else:
        text = _plain_kind(field)
    empty = any(o.get("type") == "null" for o in field.get("anyOf", []))
    return f"{text} or none" if empty else text


def _plain_kind(field: Schema) -> str:
    options = [o for o in field.get("anyOf", []) if o.get("type") != "null"]
    if len(options) == 1:
        return _plain_kind(options[0])
    if "const" in field:
        return f"`{field['const']}`"
    if tuple(field.get("enum", ())) == MEASURES:
        return "measure"
    if "enum" in field:
        return ", ".join(f"`{value}`" for value in field["enum"])
    if field.get("type") == "array":
        if "prefixItems" in field:
            return f"{len(field['prefixItems'])} numbers"
        return f"list of {_plain_kind(field['items'])}"
    return TYPES.get(field.get("type", ""), "object")


def unit(field: Schema, inner: Schema) -> str:
    if "units" in field:
        return f"that of `{field['unit_of']}`"
    return field.get("unit") or inner.get("unit", "")


def range_of(inner: Schema, field: Schema) -> str:
    low = inner.get("minimum", inner.get("exclusiveMinimum"))
    high = inner.get("maximum", inner.get("exclusiveMaximum"))
    text = ""
    if low is not None or high is not None:
        left = "(" if low is None or "exclusiveMinimum" in inner else "["
        right = ")" if high is None or "exclusiveMaximum" in inner else "]"
        text = f"{left}{_number(low, '−∞')}, {_number(high, '∞')}{right}"
    length = [field.get("minItems"), field.get("maxItems")]
    if any(length):
        counted = f"{length[0] or 0} to {length[1]:,}" if length[1] else f"at least {length[0]}"
        text = f"{counted} of them" + (f", each {text}" if text else "")
    if inner.get("type") == "string" and "maxLength" in inner:
        return f"at most {inner['maxLength']:,} characters"
    return text


def _number(value: float | None, none: str) -> str:
    if value is None:
        return none
    whole = float(value).is_integer() and abs(value) < 1e12
    return f"{int(value):,}" if whole else f"{value:g}"


def default(field: Schema, defined: Schema, required: bool) -> str:
    if "default" not in field:
        return "required" if required else "that of the measure"
    value = field["default"]
    if isinstance(value, dict):
        usual = _defaults(field, value, defined)
        other = {k: v for k, v in value.items() if v != usual.get(k)}
        words = [_tag(value)] if len(refs(field)) > 1 else []
        words += [f"{name} {_word(given)}" for name, given in other.items()]
        return ", ".join(words) or "all defaults"
    return _word(value)


def _defaults(field: Schema, value: Schema, defined: Schema) -> Schema:
    """Return the defaults of the part to which a default belongs."""
    for ref in refs(field):
        fields = defined[ref]["properties"]
        tags = {tag: value.get(tag) for tag in TAGS if tag in fields}
        tagged = all(fields[tag].get("const") == tags[tag] for tag in tags)
        if set(fields) == set(value) and tagged:
            return {name: one.get("default") for name, one in fields.items()} | tags
    return {}


def _word(value: Any) -> str:
    if value is None:
        return "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list):
        text = ", ".join(map(_word, value))
        return text if len(text) <= MAX_LENGTH else f"{text[:MAX_LENGTH].rpartition(', ')[0]} …"
    return _tag(value) if isinstance(value, dict) else str(value)


def _tag(value: Schema) -> str:
    named = next((str(value[tag]) for tag in ("digit", "name", *TAGS) if tag in value), None)
    return named or ", ".join(f"{k} {_word(v)}" for k, v in value.items())


def text_of(schema: Schema) -> str:
    return " ".join(schema.get("description", "").split())


HEAD = """# Every field of a spec

A spec is a JSON object with an `experiment`. A field that is left out has its default, and an
unknown field is refused. Lengths are in cells and times in steps of the lattice, whose density
is 1 at rest; a field without a unit has none. The range (a, b) excludes its ends, [a, b]
includes them. The source names the origin of the method; *Tensen et al. 2026* is the
Microcosmos paper, with which [reproduction.md](reproduction.md) compares each value. This page
is generated: `python -m microcosmos.spec.reference > docs/spec.md`.
"""

MEASURES_PAGE = "reference/measures.md#all-measures"
COLUMNS = ("field", "type", "unit", "range", "default", "meaning", "source")


def reference() -> str:
    """Return the whole document."""
    experiments = list(EXPERIMENTS.values())
    return "\n".join(
        [
            HEAD,
            *_contents(),
            *(line for one in experiments for line in _experiment_lines(one)),
            "## Parts\n",
            *(line for part in parts() for line in _part_lines(part)),
        ]
    )


def _contents() -> Iterator[str]:
    experiments = ", ".join(f"[`{name}`](#{name})" for name in EXPERIMENTS)
    links = ", ".join(f"[{part.name}](#{part.name.lower()})" for part in parts())
    yield f"Experiments: {experiments}.\n"
    recorded = f"[measures]({MEASURES_PAGE})"
    yield f"Parts: {links}. The numbers that an evaluation records: {recorded}.\n"
    yield "## Experiments\n"


def _experiment_lines(chosen: Experiment) -> Iterator[str]:
    yield f"### {chosen.name}\n"
    yield f"{chosen.title}: {chosen.about}. {experiment(chosen.name).text}\n"
    yield from _table(experiment(chosen.name).fields)
    if chosen.presets:
        yield "Presets: " + "; ".join(f"`{p.name}`: {p.title}" for p in chosen.presets) + ".\n"


def _part_lines(part: Part) -> Iterator[str]:
    yield f"### {part.name}\n"
    yield part.text + (f" *Source: {part.source}.*" if part.source else "") + "\n"
    yield f"Used at {', '.join(f'`{path}`' for path in part.paths)}.\n"
    yield from _table(part.fields)


def _table(fields: tuple[Field, ...]) -> Iterator[str]:
    yield _row(COLUMNS)
    yield _row(["---"] * len(COLUMNS))
    for field in fields:
        yield _row((f"`{field.name}`", *field[1:]))
    yield ""


def _row(values: Any) -> str:
    return "| " + " | ".join(str(value).replace("|", "\\|") for value in values) + " |"


if __name__ == "__main__":
    sys.stdout.write(reference())
