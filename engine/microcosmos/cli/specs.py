"""Specs from files, or presets by name."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ..spec import EXPERIMENTS, Evolution, Spec, field_path, parse
from .app import fail
from .overrides import applied


def read_spec(name: str) -> Spec:
    path = Path(name)
    if path.is_file():  # A folder may be called like a preset.
        return _parse(path)
    found = presets().get(name)
    if found is None:
        fail(f"SPEC needs a file, or one of the presets {', '.join(presets())}; got {name}")
    return found


def lasting(spec: Spec, generations: int) -> Spec:
    """A search with another number of generations."""
    if not isinstance(spec, Evolution):
        fail(f"--generations needs a search's spec, got {spec.experiment}")
    try:
        search = {**spec.search.model_dump(), "generations": generations}
        return parse({**spec.model_dump(mode="json"), "search": search})
    except ValidationError as error:
        fail("\n".join(f"--generations: {said(found)}" for found in error.errors()))


def changed(spec: Spec, settings: Sequence[str]) -> Spec:
    """Return the spec with the fields of `--set` applied."""
    if not settings:
        return spec
    try:
        return parse(applied(spec.model_dump(mode="json"), settings))
    except ValidationError as error:
        fail("\n".join(f"--set: {said(found)}" for found in error.errors()))


def presets() -> dict[str, Spec]:
    """By experiment and name; those of quality-diversity by their name alone as well."""
    named = {f"{e.name}/{p.name}": p.spec for e in EXPERIMENTS.values() for p in e.presets}
    return {p.name: p.spec for p in EXPERIMENTS["quality-diversity"].presets} | named


def _parse(path: Path) -> Spec:
    try:
        return parse(json.loads(path.read_bytes()))
    except ValidationError as error:
        fail("\n".join(f"{path}: {said(found)}" for found in error.errors()))
    except (ValueError, RecursionError, OSError) as error:
        fail(f"{path}: {error}")


def said(error: Mapping[str, Any]) -> str:
    """The field, what was needed and what came, on one line."""
    field = field_path(error["loc"])
    needed = str(error["msg"]).removeprefix("Value error, ")
    return f"{field}: {needed}" + ("" if "got" in needed else f"; got {error['input']!r:.80}")
