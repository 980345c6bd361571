"""Specs from files, or presets by name."""

import json
from collections.abc import Sequence
from pathlib import Path

from ..spec import EXPERIMENTS, Evolution, Spec, parse
from .app import fail, failing
from .overrides import applied


def read_spec(name: str) -> Spec:
    path = Path(name)
    if path.is_file():  # A folder may have the name of a preset.
        with failing(path):
            return parse(json.loads(path.read_bytes()))
    found = presets().get(name)
    if found is None:
        fail(f"SPEC needs a file, or one of the presets {', '.join(presets())}; got {name}")
    return found


def with_generations(spec: Spec, generations: int) -> Spec:
    """Return a search with another number of generations."""
    if not isinstance(spec, Evolution):
        fail(f"--generations needs a search's spec, got {spec.experiment}")
    return changed(spec, [f"search.generations={generations}"], "--generations")


def changed(spec: Spec, settings: Sequence[str], option: str = "--set") -> Spec:
    """Return the spec with some fields set."""
    with failing(option):
        return parse(applied(spec.model_dump(mode="json"), settings)) if settings else spec


def presets() -> dict[str, Spec]:
    """By experiment and name; those of quality-diversity by their name alone as well."""
    named = {f"{e.name}/{p.name}": p.spec for e in EXPERIMENTS.values() for p in e.presets}
    return {p.name: p.spec for p in EXPERIMENTS["quality-diversity"].presets} | named
