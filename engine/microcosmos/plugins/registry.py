"""The plug-ins loaded in this process, by kind and name."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from traceback import extract_tb
from typing import Any, Protocol

from pydantic import BaseModel, ValidationError

from ..invalid import InvalidField, invalid_field
from .declaration import Declaration

HELP = "see docs/plugins.md"


class Missing(ValueError):
    """A plug-in is not loaded in this process, or only in another version."""


class Broken(ValueError):
    """A plug-in fails, or returns an unusable value."""


@dataclass(frozen=True)
class Plugin:
    """A declaration and its function."""

    declaration: Declaration
    function: Callable[..., Any]
    model: type[BaseModel] | None
    location: str
    """Path of the module's file."""

    def __call__(self, *given: Any, settings: Mapping[str, Any]) -> Any:
        """Call the function; raise `Broken` with its place in the file where it fails."""
        try:
            chosen = () if self.model is None else (self.model.model_validate(dict(settings)),)
            return self.function(*given, *chosen)
        except Exception as error:
            place = f"{self.location}{line_suffix(error, self.location)}"
            text = f"{self.declaration.name} ({place}) failed with {told(error)}"
            raise Broken(text) from error


class Catalogue(Protocol):
    """A list of available plug-ins."""

    def versions(self, kind: str, name: str) -> Sequence[Declaration]:
        """Return the available versions of a name, the default first."""
        ...

    def settings(self, declared: Declaration, given: Mapping[str, Any]) -> dict[str, Any]:
        """Return all settings, checked; `ValueError` names the wrong one."""
        ...

    def explain_unknown(self, kind: str, name: str) -> str:
        """Return a sentence about an unknown name."""
        ...


def line_suffix(error: BaseException, file: str) -> str:
    """Return ", line N" for an error that arose in the file, else an empty text."""
    lines = [one.lineno for one in extract_tb(error.__traceback__) if one.filename == file]
    return f", line {lines[-1]}" if lines else ""


def told(error: BaseException) -> str:
    """Return the class of an error and its text, also if it has none."""
    try:
        fields = error.errors(include_url=False) if isinstance(error, ValidationError) else ()
        wrong = [invalid_field(one, ".".join(map(str, one["loc"]))) for one in fields]
        text = "; ".join(map(str, wrong)) or str(error)
    except Exception:  # The module may have defined its text too.
        text = "an error without a text"
    return f"{type(error).__name__}: {text}"


_plugins: dict[tuple[str, str], Plugin] = {}


class Loaded:
    """The plug-ins of this process: at most one version per name."""

    def versions(self, kind: str, name: str) -> Sequence[Declaration]:
        plugin = _plugins.get((kind, name))
        return [plugin.declaration] if plugin else []

    def settings(self, declared: Declaration, given: Mapping[str, Any]) -> dict[str, Any]:
        model = _plugins[declared.kind, declared.name].model
        if model is None:
            if given:
                raise InvalidField("plugin.settings", f"must be empty for {declared.name}")
            return {}
        try:
            return model.model_validate(dict(given)).model_dump(mode="json")
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            place = ".".join(map(str, ("plugin.settings", *first["loc"])))
            raise invalid_field(first, place) from error

    def explain_unknown(self, kind: str, name: str) -> str:
        known = [name for one, name in _plugins if one == kind]
        have = f"loaded are {', '.join(known)}" if known else "none is loaded"
        return f"{have}; give its module with --module, {HELP}"


LOADED = Loaded()


def loaded() -> tuple[Plugin, ...]:
    """Return all loaded plug-ins, in the order of loading."""
    return tuple(_plugins.values())


def find(kinds: Iterable[str], name: str, source: str) -> Plugin:
    """Return a version of a plug-in; raise `Missing` where it is not loaded."""
    plugin = next((_plugins[kind, name] for kind in kinds if (kind, name) in _plugins), None)
    if plugin is None:
        raise Missing(
            f"{name} (version {source[:12]}) is not loaded here: give its module with "
            f"--module, {HELP}"
        )
    if plugin.declaration.source != source:
        raise Missing(
            f"{name} must be of version {source[:12]}, got version "
            f"{plugin.declaration.source[:12]}: {plugin.location} has changed"
        )
    return plugin


def replace(namespace: str, plugins: Iterable[Plugin]) -> None:
    """Register the plug-ins of a module in place of its former ones."""
    for key in [key for key in _plugins if key[1].partition(".")[0] == namespace]:
        del _plugins[key]
    for plugin in plugins:
        _plugins[plugin.declaration.kind, plugin.declaration.name] = plugin


def location_of(namespace: str) -> str | None:
    """Return the file of the module with a namespace, if there is one."""
    inside = (one for key, one in _plugins.items() if key[1].partition(".")[0] == namespace)
    return next((one.location for one in inside), None)
