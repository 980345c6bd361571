"""Reference of the HTTP API: a page for each tag of web/openapi.json, and one for the types."""

import json
from collections import defaultdict
from typing import Any

from reference import write_pages
from sphinx.application import Sphinx

Json = dict[str, Any]


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("builder-inited", write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def write(app: Sphinx) -> None:
    """Write `http/*.md` beside the other sources."""
    document = json.loads((app.srcdir.parent / "web" / "openapi.json").read_text())
    tags: dict[str, list[str]] = defaultdict(list)
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            tag = operation.get("tags", ["other"])[0]
            tags[tag].append(endpoint(method, path, operation, document))
    pages = {tag: f"# {title(tag)}\n\n" + "\n".join(parts) for tag, parts in tags.items()}
    pages["types"] = types(document["components"]["schemas"])
    write_pages(app.srcdir / "http", pages)


def endpoint(method: str, path: str, operation: Json, document: Json) -> str:
    """One operation: scope, description, parameters, body, answers."""
    parts = [f"## `{method.upper()} {path}`", scope(operation, document)]
    parts.append(operation.get("description", operation.get("summary", "") + "."))
    if parameters := operation.get("parameters"):
        parts.append("| parameter | in | type | default |\n|---|---|---|---|")
        parts[-1] += "".join("\n" + parameter(one) for one in parameters)
    if body := operation.get("requestBody"):
        parts.append("**Body:** " + content(body))
    parts.append("| status | answer |\n|---|---|")
    for status, answer in operation["responses"].items():
        status = "error" if status == "default" else status
        words = cell(answer.get("description", "")).replace("Successful Response", "")
        parts[-1] += f"\n| {status} | {words} {content(answer)} |"
    return "\n\n".join(part for part in parts if part) + "\n"


def scope(operation: Json, document: Json) -> str:
    """The scope that a token needs; an empty list means that no token is ever needed."""
    needs = operation.get("security", document.get("security", []))
    if not needs:
        return "**Scope:** public; no token is needed."
    scopes = dict.fromkeys(name for need in needs for names in need.values() for name in names)
    return "**Scope:** " + ", ".join(f"`{name}`" for name in scopes) if scopes else ""


def parameter(one: Json) -> str:
    schema = one["schema"]
    given = "required" if one.get("required") else literal(schema.get("default"))
    words = cell(one.get("description", schema.get("description", "")))
    named = f"`{one['name']}`" + (f": {words}" if words else "")
    return f"| {named} | {one['in']} | {kind(schema)} | {given} |"


def content(part: Json) -> str:
    """Media types with their schemas."""
    found = [
        f"`{media}`" + (f": {shown}" if (shown := kind(one.get("schema", {}))) else "")
        for media, one in part.get("content", {}).items()
    ]
    return "; ".join(found)


def types(schemas: dict[str, Json]) -> str:
    """Every named type with its fields."""
    parts = ["# Types\n"]
    for name, schema in sorted(schemas.items()):
        parts.append(f"(type-{name.lower()})=\n## {name}\n\n{schema.get('description', '')}\n")
        if fields := schema.get("properties"):
            required = schema.get("required", [])
            parts.append("| field | type | default | |\n|---|---|---|---|")
            parts += [field(key, one, key in required) for key, one in fields.items()]
        else:
            parts.append(kind(schema))
        parts.append("")
    return "\n".join(parts)


def field(name: str, schema: Json, required: bool) -> str:
    given = "required" if required else literal(schema.get("default"))
    return f"| `{name}` | {kind(schema)} | {given} | {cell(schema.get('description', ''))} |"


def kind(schema: Json) -> str:
    """The type of a value in words, with its bounds."""
    if ref := schema.get("$ref"):
        name = ref.rsplit("/", 1)[-1]
        return f"[{name}](#type-{name.lower()})"
    for union in ("anyOf", "oneOf"):
        if union in schema:
            return " or ".join(dict.fromkeys(filter(None, map(kind, schema[union]))))
    if "enum" in schema:
        return ", ".join(literal(value) for value in schema["enum"])
    if "const" in schema:
        return literal(schema["const"])
    word = schema.get("type", "")
    if word == "array":
        word = f"list of {kind(schema.get('items', {})) or 'values'}"
    elif schema.get("format"):
        word += f" ({schema['format']})"
    return word + bounds(schema)


def bounds(schema: Json) -> str:
    signs = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}
    limits = [f"{sign} {schema[key]}" for key, sign in signs.items() if key in schema]
    for low, high in (("minLength", "maxLength"), ("minItems", "maxItems")):
        if low in schema or high in schema:
            limits.append(f"length {schema.get(low, 0)} to {schema.get(high, '∞')}")
    return f", {', '.join(limits)}" if limits else ""


def literal(value: Any) -> str:
    return "" if value is None else f"`{json.dumps(value)}`"


def cell(text: str) -> str:
    return text.replace("\n", " ").replace("|", r"\|")


def title(tag: str) -> str:
    return tag[:1].upper() + tag[1:].replace("_", " ")
