"""Specs from files, presets or shares, and fields set by their dotted paths."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import typer

from ..client import shared
from ..spec import Evolution, Spec, parse
from ..spec.experiments import presets
from .app import fail, failing


def read_spec(name: str) -> Spec:
    if address := shared.address(name):
        with failing(name):
            return parse(shared.spec(address))
    path = Path(name)
    if path.is_file():  # A folder may have the name of a preset.
        with failing(path):
            return parse(json.loads(path.read_bytes()))
    found = presets().get(name)
    if found is None:
        fail(f"SPEC needs a file, or one of the presets {', '.join(presets())}; got {name}")
    return found


def spec_path(name: str) -> Path:
    """Return the path beside which the archive of a spec's run is written."""
    if address := shared.address(name):
        return Path(f"share-{address.slug[:8]}")
    return Path(name.replace("/", "-") if name in presets() else name)


def with_generations(spec: Spec, generations: int) -> Spec:
    """Return a search with another number of generations."""
    if not isinstance(spec, Evolution):
        fail(f"--generations needs a search's spec, got {spec.experiment}")
    return changed(spec, [f"search.generations={generations}"], "--generations")


def changed(spec: Spec, settings: Sequence[str], option: str = "--set") -> Spec:
    """Return the spec with some fields set."""
    with failing(option):
        return parse(applied(spec.model_dump(mode="json"), settings)) if settings else spec


def value(text: str, path: str) -> Any:
    """Parse the JSON of a field; return other text as it is."""
    try:
        found = json.loads(text)
    except ValueError:
        return text
    try:
        json.dumps(found, allow_nan=False)
    except ValueError:
        raise typer.BadParameter(f"{path} needs finite numbers; got {text}") from None
    return found


def pair(text: str, option: str) -> tuple[str, str]:
    path, equals, given = text.partition("=")
    if not equals or not all(path.strip().split(".")):
        raise typer.BadParameter(
            f"{option} needs FIELD=VALUE, such as world.viscosity=0.1; got {text!r}"
        )
    return path.strip(), given.strip()


def applied(spec: dict[str, Any], settings: Sequence[str]) -> dict[str, Any]:
    """Return a copy of a spec with some fields set; missing parts are added."""
    spec = json.loads(json.dumps(spec))
    for text in settings:
        path, given = pair(text, "--set")
        *parents, last = path.split(".")
        place: Any = spec
        for name in parents:
            place = _part(place, name, path)
        place[_key(place, last, path)] = value(given, path)
    return spec


def patch(settings: Sequence[str]) -> dict[str, Any]:
    """Return the fields to merge into a spec; lists are replaced whole."""
    for text in settings:
        path, _ = pair(text, "--set")
        if any(name.isdigit() for name in path.split(".")):
            raise typer.BadParameter(
                f"a fork replaces a list as a whole: --set needs the list, got {path}"
            )
    return applied({}, settings)


def grid(sweeps: Sequence[str]) -> dict[str, list[Any]]:
    """Return values by path, each once: a JSON list, or values with commas between them."""
    found: dict[str, list[Any]] = {}
    for text in sweeps:
        path, given = pair(text, "--sweep")
        if path in found:
            raise typer.BadParameter(
                f"--sweep needs a field once, with all its values; got {path} twice"
            )
        whole = value(given, path)
        parts = given.split(",")
        found[path] = whole if isinstance(whole, list) else [value(one, path) for one in parts]
    return found


def region(bounds: Sequence[str]) -> dict[str, list[float]]:
    """Return low and high by axis, each once."""
    found: dict[str, list[float]] = {}
    for text in bounds:
        axis, given = pair(text, "--region")
        if axis in found:
            raise typer.BadParameter(f"--region needs an axis once; got {axis} twice")
        try:
            low, high = map(float, given.split(":"))
        except ValueError:
            raise typer.BadParameter(
                f"--region needs AXIS=LOW:HIGH, such as turning=0:1.5; got {text!r}"
            ) from None
        found[axis] = [low, high]
    return found


def _part(place: Any, name: str, path: str) -> Any:
    key = _key(place, name, path)
    if isinstance(place, dict) and place.get(name) is None:
        place[name] = {}
    if isinstance(place, dict) and not isinstance(place[name], dict | list):
        raise typer.BadParameter(f"{path}: {name} has no fields; it is {place[name]!r}")
    return place[key]


def _key(place: Any, name: str, path: str) -> str | int:
    if not isinstance(place, list):
        return name
    if not name.isdigit() or int(name) >= len(place):
        raise typer.BadParameter(
            f"{path}: needs a number from 0 to {len(place) - 1}; got {name}"
        )
    return int(name)
