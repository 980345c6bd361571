"""Specs to submit: an object, a file, a preset by its name, or a shared run by its address."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..invalid import InvalidField
from ..json_text import read_json
from . import sharing
from .connection import Connection


def document(connection: Connection, spec: Any) -> dict[str, Any]:
    """Return the spec as JSON; the server validates it and knows the presets."""
    if isinstance(spec, Mapping):
        return dict(spec)
    if hasattr(spec, "model_dump"):
        return spec.model_dump(mode="json")
    if not isinstance(spec, str | Path):
        needed = "must be a spec, a file or a preset's name"
        raise InvalidField("spec", f"{needed}; got {spec!r:.80}")
    if address := sharing.address(str(spec)):
        return sharing.spec(address)
    if Path(spec).is_file():
        return read(Path(spec))
    return preset(connection, str(spec))


def read(path: Path) -> dict[str, Any]:
    """Return the spec in a file. Raise `ValueError` if there is none."""
    return parsed(path.read_bytes(), str(path))


def parsed(data: bytes, source: str) -> dict[str, Any]:
    """Return the spec in bytes from a source. Raise `ValueError` if there is none."""
    try:
        document = read_json(data)
    except ValueError as error:
        raise ValueError(
            f"{source} needs a spec as JSON; got something else: {error}"
        ) from error
    if not isinstance(document, dict):
        raise ValueError(f"{source} needs a spec as a JSON object; got {document!r:.80}")
    return document


def preset(connection: Connection, name: str) -> dict[str, Any]:
    """Return a preset by experiment and name, or by the name alone in quality-diversity."""
    known = {
        f"{experiment['experiment']}/{one['name']}": one["spec"]
        for experiment in connection.items("experiments")
        for one in experiment["presets"]
    }
    spec = known.get(name) or known.get(f"quality-diversity/{name}")
    if spec is None:
        raise ValueError(
            f"`spec` needs a file, or one of the presets {', '.join(known)}; got {name}"
        )
    return spec
