"""Types, ranges and defaults of fields in words, from their JSON schemas."""

from typing import Any

Schema = dict[str, Any]

MAX_LENGTH = 60
"""Maximum length of a written-out default."""

TYPES = {"integer": "integer", "number": "number", "boolean": "yes or no", "string": "text"}
TAGS = ("experiment", "builder", "encoding", "operator", "kind")
"""Fields whose one value says which part it is."""


def plain(field: Schema) -> Schema:
    """Return the inner schema: x of `x | None`, and the entry of a list."""
    options = [o for o in field.get("anyOf", [field]) if o.get("type") != "null"]
    inner = options[0] if len(options) == 1 else field
    items = inner.get("items")
    return items if isinstance(items, dict) and "prefixItems" not in inner else inner


def items(field: Schema) -> bool:
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
        said = f"list of {links}" if items(field) else links
    else:
        said = _said(field)
    empty = any(o.get("type") == "null" for o in field.get("anyOf", []))
    return f"{said} or none" if empty else said


def _said(field: Schema) -> str:
    options = [o for o in field.get("anyOf", []) if o.get("type") != "null"]
    if len(options) == 1:
        return _said(options[0])
    if "const" in field:
        return f"`{field['const']}`"
    if "enum" in field:
        return ", ".join(f"`{value}`" for value in field["enum"])
    if field.get("type") == "array":
        if "prefixItems" in field:
            return f"{len(field['prefixItems'])} numbers"
        return f"list of {_said(field['items'])}"
    return TYPES.get(field.get("type", ""), "object")


def unit(field: Schema, plain: Schema) -> str:
    if "units" in field:
        return f"that of `{field['unit_of']}`"
    return field.get("unit") or plain.get("unit", "")


def range_of(plain: Schema, field: Schema) -> str:
    low = plain.get("minimum", plain.get("exclusiveMinimum"))
    high = plain.get("maximum", plain.get("exclusiveMaximum"))
    found = ""
    if low is not None or high is not None:
        left = "(" if low is None or "exclusiveMinimum" in plain else "["
        right = ")" if high is None or "exclusiveMaximum" in plain else "]"
        found = f"{left}{_number(low, '−∞')}, {_number(high, '∞')}{right}"
    length = [field.get("minItems"), field.get("maxItems")]
    if any(length):
        counted = f"{length[0] or 0} to {length[1]:,}" if length[1] else f"at least {length[0]}"
        found = f"{counted} of them" + (f", each {found}" if found else "")
    if plain.get("type") == "string" and "maxLength" in plain:
        found = f"at most {plain['maxLength']:,} letters"
    return found


def _number(value: float | None, none: str) -> str:
    if value is None:
        return none
    whole = float(value).is_integer() and abs(value) < 1e12
    return f"{int(value):,}" if whole else f"{value:g}"


def default(field: Schema, defined: Schema, required: bool) -> str:
    if "default" not in field:
        return "to be given" if required else "the measure’s own"
    value = field["default"]
    if isinstance(value, dict):
        usual = _usual(field, value, defined)
        other = {k: v for k, v in value.items() if v != usual.get(k)}
        named = [_tag(value)] if len(refs(field)) > 1 else []
        said = named + [f"{name} {_word(given)}" for name, given in other.items()]
        return ", ".join(said) or "its own"
    return _word(value)


def _usual(field: Schema, value: Schema, defined: Schema) -> Schema:
    """Return the defaults of the part to which a default belongs."""
    for ref in refs(field):
        own = defined[ref]["properties"]
        tagged = all(own[t].get("const") == value.get(t) for t in TAGS if t in own)
        if set(own) == set(value) and tagged:
            return {name: one.get("default") for name, one in own.items()} | {
                t: value[t] for t in TAGS if t in own
            }
    return {}


def _word(value: Any) -> str:
    if value is None:
        return "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list):
        if value and isinstance(value[0], dict):
            words = [_tag(one) for one in value]
        else:
            words = [_word(one) for one in value]
        text = ", ".join(words)
        return text if len(text) <= MAX_LENGTH else f"{text[:MAX_LENGTH].rpartition(', ')[0]} …"
    return _tag(value) if isinstance(value, dict) else str(value)


def _tag(value: Schema) -> str:
    """Name a part by its name or tag."""
    named = next((str(value[t]) for t in ("name", *TAGS, "digit") if t in value), None)
    if "digit" in value:
        return f"{value['digit']}"
    return named or ", ".join(f"{k} {_word(v)}" for k, v in value.items())


def line(text: str) -> str:
    return " ".join(text.split())
