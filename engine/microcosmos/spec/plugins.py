"""Plug-ins in a spec: their versions and settings."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import Field, PlainSerializer, ValidationInfo, WrapValidator, model_validator
from pydantic.json_schema import SkipJsonSchema

from .. import plugins
from ..invalid import InvalidField
from ..plugins import Catalogue, Emits, is_plugin
from .base import Digest, Part, refuse

CONTEXT = "plugins"
"""The key of the validation context under which `parse` passes a catalogue of plug-ins."""


class PluginVersion(Part):
    """The version and settings of a plug-in. All but the settings follows from its name."""

    source: Digest
    """SHA-256 of the module's source."""
    title: Annotated[str, Field(min_length=1, max_length=100)]
    """Title for people."""
    unit: Annotated[str, Field(max_length=40)] = ""
    """Unit of a measure."""
    sizes: dict[str, Annotated[int, Field(ge=0, le=65_536)]] = Field(default={})
    """Most nodes of a body, or numbers of genes of an encoding."""
    emits: Annotated[Emits | None, Field(exclude_if=lambda emits: emits is None)] = None
    """Facts about an emitter."""
    settings: dict[str, Any] = Field(default={})
    """Values of the declared settings."""


def _built_in_or_plugin(value: Any, built_in: Any) -> Any:
    return value if is_plugin(value) else built_in(value)


# The JSON schema lists the built-in names alone; the server adds the plug-ins of its workers.
OR_PLUGIN = (WrapValidator(_built_in_or_plugin), PlainSerializer(str, return_type=str))
"""Annotations that let a choice of built-in names accept names of plug-ins."""

PluginName = Annotated[str, Field(pattern=rf"^{plugins.declaration.FULL_NAME.pattern}$")]
MaybePlugin = Annotated[
    SkipJsonSchema[PluginVersion | None], Field(exclude_if=lambda plugin: not plugin)
]
PluginVersions = Annotated[
    SkipJsonSchema[dict[str, PluginVersion]], Field(exclude_if=lambda plugins: not plugins)
]


def pinned(
    kinds: tuple[str, ...], field: str, name: str, given: Any, info: ValidationInfo
) -> tuple[Any, plugins.Declaration | None]:
    """Return the version and settings of a plug-in, and its declaration if it is available.

    A version that a spec already names is accepted where it is not available: files must stay
    readable on machines that cannot run them.
    """
    if isinstance(given, PluginVersion):
        given = given.model_dump()
    if given is not None and not isinstance(given, Mapping):
        raise InvalidField("plugin", f"must be an object with `settings`, got {given!r:.80}")
    known: Catalogue = (info.context or {}).get(CONTEXT, plugins.LOADED)
    versions = [one for kind in kinds for one in known.versions(kind, name)]
    source = (given or {}).get("source")
    declared = next((one for one in versions if source in (None, one.source)), None)
    # A machine that cannot run it must still read the file.
    if declared is None and source is not None:
        return given, None
    if declared is None:
        reason = known.explain_unknown(kinds[0], name)
        raise InvalidField(field, f"must be known, got {name!r}: {reason}")
    settings = (given or {}).get("settings") or {}
    if not isinstance(settings, Mapping):
        raise InvalidField("plugin.settings", f"must be an object, got {settings!r:.80}")
    version = declared.model_dump(include={"source", "title", "unit", "sizes", "emits"})
    return version | {"settings": known.settings(declared, settings)}, declared


def completed(
    given: Any, kinds: tuple[str, ...], field: str, info: ValidationInfo
) -> tuple[Any, plugins.Declaration | None]:
    """Pin the plug-in that `field` names, if it names one, in the part's `plugin`."""
    if not isinstance(given, dict):
        return given, None
    name, plugin = given.get(field), given.get("plugin")
    if is_plugin(name):
        version, declared = pinned(kinds, field, str(name), plugin, info)
        return {**given, "plugin": version}, declared
    if isinstance(plugin, PluginVersion) or (
        isinstance(plugin, Mapping) and "source" in plugin
    ):
        # The name in a complete spec was replaced: the version of the former plug-in goes.
        return {key: value for key, value in given.items() if key != "plugin"}, None
    refuse(plugin is not None, "plugin", f"must be left out where `{field}` is {name!r}")
    return given, None


def complete_plugin(kinds: tuple[str, ...], field: str) -> Any:
    """Return a validator that pins the plug-in that `field` names."""

    def complete(cls, given: Any, info: ValidationInfo) -> Any:
        return completed(given, kinds, field, info)[0]

    return model_validator(mode="before")(complete)


@dataclass(frozen=True)
class PluginUse:
    """A plug-in that a document names."""

    path: str
    """Path of the field with its name."""
    name: str
    version: PluginVersion


NAMING = ("fitness", "name", "builder", "encoding", "swimmer", "operator")
"""Fields that may name a plug-in."""


def plugins_in(document: Any, path: str = "") -> Iterator[PluginUse]:
    """Yield the plug-ins of a spec or a creature file in JSON."""
    if isinstance(document, list):
        for number, part in enumerate(document):
            yield from plugins_in(part, f"{path}{number}.")
    if not isinstance(document, dict):
        return
    named = next((field for field in NAMING if is_plugin(document.get(field))), None)
    for field, part in document.items():
        if field == "plugin" and named and isinstance(part, dict):
            version = PluginVersion.model_validate(part)
            yield PluginUse(f"{path}{named}", document[named], version)
        elif field == "plugins" and isinstance(part, dict):
            for name, version in part.items():
                yield PluginUse(f"{path}plugins", name, PluginVersion.model_validate(version))
        else:
            yield from plugins_in(part, f"{path}{field}.")
