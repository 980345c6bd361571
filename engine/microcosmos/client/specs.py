"""Specs to submit: an object, a file, a preset by its name, or a shared run by its address."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from . import shared
from .connection import Connection


def document(connection: Connection, spec: Any) -> dict[str, Any]:
    """Return the spec as JSON; the server validates it and knows the presets."""
    if isinstance(spec, Mapping):
        return dict(spec)
    if hasattr(spec, "model_dump"):
        return spec.model_dump(mode="json")
    if not isinstance(spec, str | Path):
        raise TypeError(f"`spec` needs a spec, a file or a preset's name; got {spec!r:.80}")
    if address := shared.address(str(spec)):
        return shared.spec(address)
    if Path(spec).is_file():
        return read(Path(spec))
    return preset(connection, str(spec))


def read(path: Path) -> dict[str, Any]:
    """Return the spec in a file. Raise `ValueError` if there is none."""
    try:
        found = json.loads(path.read_bytes())
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path} needs a spec as JSON; got something else: {error}") from error
    if not isinstance(found, dict):
        raise ValueError(f"{path} needs a spec as a JSON object; got {found!r:.80}")
    return found


def preset(connection: Connection, name: str) -> dict[str, Any]:
    """Return a preset by experiment and name, or by the name alone in quality-diversity."""
    known = {
        f"{experiment['experiment']}/{one['name']}": one["spec"]
        for experiment in connection.items("experiments")
        for one in experiment["presets"]
    }
    found = known.get(name) or known.get(f"quality-diversity/{name}")
    if found is None:
        raise ValueError(
            f"`spec` needs a file, or one of the presets {', '.join(known)}; got {name}"
        )
    return found
