"""What is loaded in this process, by kind and name."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from traceback import extract_tb
from typing import Any, Protocol

from pydantic import BaseModel, ValidationError

from .declaration import Declaration

HELP = "see docs/plugins.md"


class Missing(ValueError):
    """Something of one's own that is not loaded here, or in another version."""


class Broken(ValueError):
    """Something of one's own that fails, or gives what cannot be used."""


@dataclass(frozen=True)
class Plugin:
    """A declaration and what carries it out."""

    declaration: Declaration
    function: Callable[..., Any]
    model: type[BaseModel] | None
    location: str
    """The file that it was loaded from."""

    def __call__(self, *given: Any, settings: Mapping[str, Any]) -> Any:
        """What the function gives; its errors are named as its own."""
        try:
            chosen = () if self.model is None else (self.model.model_validate(dict(settings)),)
            return self.function(*given, *chosen)
        except Exception as error:
            what = f"{self.declaration.name} ({self.location}{line_of(error, self.location)})"
            raise Broken(f"{what} failed with {type(error).__name__}: {error}") from error


class Catalogue(Protocol):
    """Whoever knows which versions of a name there are."""

    def versions(self, kind: str, name: str) -> Sequence[Declaration]:
        """The one to take where nobody says otherwise first."""
        ...

    def settings(self, declared: Declaration, given: Mapping[str, Any]) -> dict[str, Any]:
        """All settings, checked; `ValueError` names the one that is wrong."""
        ...

    def explain_unknown(self, kind: str, name: str) -> str:
        """A sentence about a name that is not known."""
        ...


def line_of(error: BaseException, file: str) -> str:
    """Where in a file something went wrong, if it did there."""
    lines = [one.lineno for one in extract_tb(error.__traceback__) if one.filename == file]
    return f", line {lines[-1]}" if lines else ""


_plugins: dict[tuple[str, str], Plugin] = {}


class Loaded:
    """What this process has loaded: at most one version of a name."""

    def versions(self, kind: str, name: str) -> Sequence[Declaration]:
        found = _plugins.get((kind, name))
        return [found.declaration] if found else []

    def settings(self, declared: Declaration, given: Mapping[str, Any]) -> dict[str, Any]:
        model = _plugins[declared.kind, declared.name].model
        if model is None:
            if given:
                raise ValueError(f"`plugin.settings` must be empty for {declared.name}")
            return {}
        try:
            return model.model_validate(dict(given)).model_dump(mode="json")
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            place = ".".join(map(str, ("plugin.settings", *first["loc"])))
            came = "" if "got" in first["msg"] else f"; got {first['input']!r:.80}"
            raise ValueError(f"`{place}` needs {first['msg']}{came}") from error

    def explain_unknown(self, kind: str, name: str) -> str:
        known = [name for one, name in _plugins if one == kind]
        have = f"loaded are {', '.join(known)}" if known else "none is loaded"
        return f"{have}; give its module with --module, {HELP}"


LOADED = Loaded()


def loaded() -> tuple[Plugin, ...]:
    """All of them, in the order in which they were loaded."""
    return tuple(_plugins.values())


def find(kinds: Iterable[str], name: str, source: str) -> Plugin:
    """What carries out a version of a name; `Missing` says what is there instead."""
    found = next((_plugins[kind, name] for kind in kinds if (kind, name) in _plugins), None)
    if found is None:
        raise Missing(
            f"{name} (version {source[:12]}) is not loaded here: give its module with "
            f"--module, {HELP}"
        )
    if found.declaration.source != source:
        raise Missing(
            f"{name} must be of version {source[:12]}, got version "
            f"{found.declaration.source[:12]}: {found.location} is not what it was"
        )
    return found


def replace(namespace: str, plugins: Iterable[Plugin]) -> None:
    """Take up all that a module adds, in place of what it added before."""
    for key in [key for key in _plugins if key[1].partition(".")[0] == namespace]:
        del _plugins[key]
    for plugin in plugins:
        _plugins[plugin.declaration.kind, plugin.declaration.name] = plugin


def location_of(namespace: str) -> str | None:
    """The file of the module that has a namespace, if one has."""
    inside = (one for key, one in _plugins.items() if key[1].partition(".")[0] == namespace)
    return next((one.location for one in inside), None)
