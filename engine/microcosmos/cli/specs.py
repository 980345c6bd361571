"""Specs from files, presets or shares, and fields set by their dotted paths."""

import json
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import typer

from ..client import sharing
from ..client import specs as server_specs
from ..invalid import InvalidField
from ..json_text import read_json
from ..spec import Evolution, Spec, parse
from ..spec.experiments import presets
from .app import fail, failing

INPUT = "-"
"""The name of a spec in the standard input."""


def standard_input() -> dict[str, Any]:
    """Return the spec in the standard input. Raise `ValueError` if there is none."""
    if sys.stdin is None:
        raise ValueError("standard input must be open for a spec named -")
    return server_specs.parsed(sys.stdin.buffer.read(), "standard input")


def read_spec(name: str) -> Spec:
    if address := sharing.address(name):
        with failing("SPEC"):
            return parse(sharing.spec(address))
    if name == INPUT:
        with failing():
            return parse(standard_input())
    path = Path(name)
    # A name may be longer than that of any file, or below a folder that may not be read.
    with failing("SPEC"):
        is_file = path.is_file()  # A folder may have the name of a preset.
    if is_file:
        with failing(path):
            return parse(read_json(path.read_bytes()))
    preset = presets().get(name)
    if preset is None:
        fail(f"SPEC needs a file, or one of the presets {', '.join(presets())}; got {name}")
    return preset


def spec_path(name: str) -> Path:
    """Return the path beside which the archive of a spec's run is written."""
    if address := sharing.address(name):
        return Path(f"share-{address.slug[:8]}")
    if name == INPUT:
        return Path("spec")
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
        parsed = read_json(text)
    except InvalidField as error:
        raise typer.BadParameter(f"{path}: {error}") from None
    except ValueError:
        return text
    try:
        # Python's JSON reads NaN and Infinity, which JSON and the server do not have.
        json.dumps(parsed, allow_nan=False)
    except ValueError:
        raise typer.BadParameter(f"{path} needs finite numbers; got {text}") from None
    return parsed


def pair(text: str, option: str) -> tuple[str, str]:
    path, equals, given = text.partition("=")
    if not equals or not all(path.strip().split(".")):
        raise typer.BadParameter(
            f"{option} needs FIELD=VALUE, such as world.viscosity=0.1; got {text!r}"
        )
    return path.strip(), given.strip()


def applied(spec: dict[str, Any], settings: Sequence[str]) -> dict[str, Any]:
    """Return a copy of a spec with some fields set; missing parts are added."""
    # A deep copy whose parts are plain JSON, which the paths below walk through.
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
    values: dict[str, list[Any]] = {}
    for text in sweeps:
        path, given = pair(text, "--sweep")
        if path in values:
            raise typer.BadParameter(
                f"--sweep needs a field once, with all its values; got {path} twice"
            )
        whole = value(given, path)
        # Other than what was given, it is JSON, whose commas part nothing.
        parts = [whole] if whole != given else [value(one, path) for one in given.split(",")]
        values[path] = whole if isinstance(whole, list) else parts
    return values


def region(bounds: Sequence[str]) -> dict[str, list[float]]:
    """Return low and high by axis, each once."""
    ends: dict[str, list[float]] = {}
    for text in bounds:
        axis, given = pair(text, "--region")
        if axis in ends:
            raise typer.BadParameter(f"--region needs an axis once; got {axis} twice")
        try:
            low, high = map(float, given.split(":"))
        except ValueError:
            low = high = math.nan
        if not (math.isfinite(low) and math.isfinite(high)):
            raise typer.BadParameter(
                "--region needs AXIS=LOW:HIGH with finite numbers, such as turning=0:1.5; "
                f"got {text!r}"
            )
        ends[axis] = [low, high]
    return ends


def _part(place: Any, name: str, path: str) -> Any:
    key = _key(place, name, path)
    if isinstance(place, dict) and place.get(name) is None:
        place[name] = {}
    if not isinstance(place[key], dict | list):
        raise typer.BadParameter(f"{path}: {name} has no fields; it is {place[key]!r}")
    return place[key]


def _key(place: Any, name: str, path: str) -> str | int:
    if not isinstance(place, list):
        return name
    if not name.isdigit() or int(name) >= len(place):
        raise typer.BadParameter(
            f"{path}: needs a number from 0 to {len(place) - 1}; got {name}"
        )
    return int(name)
