"""Schemas of experiments with the plug-ins of workers among the choices."""

from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from functools import cache
from typing import Any

from microcosmos.plugins import Declaration
from microcosmos.spec import PluginControl

Schema = dict[str, Any]
Having = Callable[[str], list[str]]
"""From a version to the names of the workers that have it."""


def with_plugins(schema: Schema, offered: Sequence[Declaration], having: Having) -> Schema:
    """The same with more choices; `plugins` lists the workers that offer each."""
    whole = deepcopy(schema)
    parts = whole.get("$defs", {})
    kinds = {kind: [one for one in offered if one.kind in kind] for kind in CHOICES}
    for kind, (owner, field) in CHOICES.items():
        if owner in parts and kinds[kind]:
            _choose(parts[owner], field, kinds[kind], parts, having)
    for kind, (field, tag) in UNIONS.items():
        union = whole["properties"].get(field, {})
        if "oneOf" in union:
            mine = [one for one in offered if one.kind in kind]
            union["oneOf"] += [_part(one, tag, parts, having) for one in mine]
    swimmers = whole["properties"].get("swimmers")
    if swimmers:
        swimmers["items"]["enum"] += [one.name for one in offered if one.kind == "gait"]
    return whole


CHOICES = {("fitness",): ("Task", "fitness"), ("descriptor",): ("Descriptor", "name")}
UNIONS = {("body", "gait"): ("body", "builder"), ("encoding",): ("control", "encoding")}


def _choose(
    owner: Schema, field: str, mine: Sequence[Declaration], parts: Schema, having: Having
) -> None:
    """More words for a choice, their units, and settings that go with some of them."""
    properties = owner["properties"]
    properties[field]["enum"] += [one.name for one in mine]
    properties[field]["plugins"] = {one.name: _told(one, having) for one in mine}
    for other in properties.values():
        if other.get("unit_of") == field:
            other["units"] |= {one.name: one.unit for one in mine}
    settings = {one.name: _settings(one, parts) for one in mine if one.settings}
    if settings:
        properties["plugin"] = {"settings_of": field, "parts": settings}


def _part(one: Declaration, tag: str, parts: Schema, having: Having) -> Schema:
    """One more of several parts."""
    told = _told(one, having)
    properties = {tag: {"const": one.name, "type": "string"}}
    if one.kind == "encoding":
        properties |= deepcopy(_actuation())
    if one.settings:
        properties["plugin"] = _settings(one, parts)
    about = [
        told["about"] or f"{one.title}.",
        f"Plug-in on {', '.join(told['workers'])}.",
    ]
    return {
        "type": "object",
        "title": one.title,
        "description": " ".join(about),
        "properties": properties,
        "plugin": told,
    }


def _settings(one: Declaration, parts: Schema) -> Schema:
    """The schema of `plugin`: the settings, shown as if they were fields beside it."""
    settings = _moved(dict(one.settings or {}), f"{one.name}.")
    for name, part in settings.pop("$defs", {}).items():
        parts[f"{one.name}.{name}"] = part
    default = {"settings": one.defaults}
    settings["inline"] = True
    properties = {"settings": settings}
    return {"type": "object", "inline": True, "default": default, "properties": properties}


def _moved(schema: Any, prefix: str) -> Any:
    """A schema whose own definitions have got another name."""
    if isinstance(schema, list):
        return [_moved(part, prefix) for part in schema]
    if not isinstance(schema, Mapping):
        return schema
    found = {name: _moved(part, prefix) for name, part in schema.items()}
    if isinstance(found.get("$ref"), str):
        found["$ref"] = found["$ref"].replace("#/$defs/", f"#/$defs/{prefix}")
    return found


def _told(one: Declaration, having: Having) -> Schema:
    return {"title": one.title, "about": one.about, "workers": having(one.source)}


@cache
def _actuation() -> Schema:
    """Fields of every plug-in encoding."""
    properties = PluginControl.model_json_schema()["properties"]
    return {n: part for n, part in properties.items() if n not in ("encoding", "plugin")}
