"""The route of experiments, from which the page builds its forms."""

from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from functools import cache
from typing import Any

from fastapi import APIRouter

from microcosmos.plugins import Declaration
from microcosmos.spec import EXPERIMENTS, Part, PluginControl, PluginEmitter

from ..auth.authorize import MAY_READ
from ..services.services import ServicesDep, SessionDep
from .known_plugins import KnownPlugins
from .schemas import ExperimentRead, PresetRead

router = APIRouter(prefix="/experiments", tags=["experiments"])


@router.get("", dependencies=[MAY_READ])
def list_experiments(services: ServicesDep, session: SessionDep) -> list[ExperimentRead]:
    """Return the experiments, with the plug-ins of live workers among the choices."""
    known = KnownPlugins(services, session)
    offered = known.offered()
    if not offered:
        return built_in()
    return [
        one.model_copy(
            update={"schema_": with_plugins(one.schema_, offered, known.workers_with)}
        )
        for one in built_in()
    ]


@cache
def built_in() -> list[ExperimentRead]:
    """Return the experiments without plug-ins; building their schemas takes 0.1 s."""
    return [
        ExperimentRead(
            experiment=name,
            title=experiment.title,
            about=experiment.about,
            schema_=experiment.spec.model_json_schema(),
            presets=[
                PresetRead(name=p.name, title=p.title, spec=p.spec.model_dump(mode="json"))
                for p in experiment.presets
            ],
        )
        for name, experiment in EXPERIMENTS.items()
    ]


Schema = dict[str, Any]
Hosts = Callable[[str], list[str]]
"""Maps a version to the names of the workers that have it."""


def with_plugins(schema: Schema, offered: Sequence[Declaration], hosts: Hosts) -> Schema:
    """Return a schema with plug-ins among its choices, each with the workers that offer it."""
    # The schema is kept and shared by all requests.
    whole = deepcopy(schema)
    parts = whole.get("$defs", {})
    kinds = {kind: [one for one in offered if one.kind in kind] for kind in CHOICES}
    for kind, (owner, field) in CHOICES.items():
        if owner in parts and kinds[kind]:
            _choose(parts[owner], field, kinds[kind], parts, hosts)
    for kind, (owner, field, tag) in UNIONS.items():
        properties = (parts.get(owner, {}) if owner else whole).get("properties", {})
        union = properties.get(field, {})
        union = union.get("items", union)
        if "oneOf" in union:
            mine = [one for one in offered if one.kind in kind]
            union["oneOf"] += [_union_member(one, tag, parts, hosts) for one in mine]
    swimmers = whole["properties"].get("swimmers")
    if swimmers:
        swimmers["items"]["enum"] += [one.name for one in offered if one.kind == "gait"]
    return whole


CHOICES = {("fitness",): ("Task", "fitness"), ("descriptor",): ("Descriptor", "name")}
UNIONS = {
    ("body", "gait"): ("", "body", "builder"),
    ("encoding",): ("", "control", "encoding"),
    ("emitter",): ("Search", "emitters", "operator"),
}
"""Kinds, the part that owns the union, empty for the spec itself, its field and its tag."""
BESIDE: dict[str, type[Part]] = {"encoding": PluginControl, "emitter": PluginEmitter}
"""Parts with fields beside the name and the settings of a plug-in."""


def _choose(
    owner: Schema,
    field: str,
    mine: Sequence[Declaration],
    parts: Schema,
    hosts: Hosts,
) -> None:
    """Add names to a choice, with their units and settings."""
    properties = owner["properties"]
    properties[field]["enum"] += [one.name for one in mine]
    properties[field]["plugins"] = {one.name: _about(one, hosts) for one in mine}
    for other in properties.values():
        if other.get("unit_of") == field:
            other["units"] |= {one.name: one.unit for one in mine}
    settings = {one.name: _settings(one, parts) for one in mine if one.settings}
    if settings:
        properties["plugin"] = {"settings_of": field, "parts": settings}


def _union_member(one: Declaration, tag: str, parts: Schema, hosts: Hosts) -> Schema:
    about = _about(one, hosts)
    workers = ", ".join(about["workers"])
    properties = {tag: {"const": one.name, "type": "string"}}
    if one.kind in BESIDE:
        properties |= deepcopy(_beside(one.kind, tag))
    if one.settings:
        properties["plugin"] = _settings(one, parts)
    return {
        "type": "object",
        "title": one.title,
        "description": f"{about['about'] or f'{one.title}.'} Plug-in on {workers}.",
        "properties": properties,
        "plugin": about,
    }


def _settings(one: Declaration, parts: Schema) -> Schema:
    """Return the schema of `plugin`, whose settings the form shows as fields beside it."""
    settings = _moved(dict(one.settings or {}), f"{one.name}.")
    for name, part in settings.pop("$defs", {}).items():
        parts[f"{one.name}.{name}"] = part
    default = {"settings": one.defaults}
    settings["inline"] = True
    properties = {"settings": settings}
    return {"type": "object", "inline": True, "default": default, "properties": properties}


def _moved(schema: Any, prefix: str) -> Any:
    """Rename the definitions of a schema and its references to them."""
    if isinstance(schema, list):
        return [_moved(part, prefix) for part in schema]
    if not isinstance(schema, Mapping):
        return schema
    found = {name: _moved(part, prefix) for name, part in schema.items()}
    if isinstance(found.get("$ref"), str):
        found["$ref"] = found["$ref"].replace("#/$defs/", f"#/$defs/{prefix}")
    return found


def _about(one: Declaration, hosts: Hosts) -> Schema:
    return {"title": one.title, "about": one.about, "workers": hosts(one.source)}


@cache
def _beside(kind: str, tag: str) -> Schema:
    properties = BESIDE[kind].model_json_schema()["properties"]
    return {name: part for name, part in properties.items() if name not in (tag, "plugin")}
