"""A creature file as HDF5: the same document, with its body and genes as arrays."""

import json
import re
from collections.abc import Mapping
from io import BytesIO
from typing import Any

import h5py
import numpy as np

from ..invalid import InvalidField
from ..naming import canonical, decode
from ..spec.creature import Identity
from . import file as hdf5
from . import hdf5_guard
from .creature import CreatureError, parse

FORMAT = "microcosmos-creature-hdf5/1"

BODY = ("positions", "edges", "joints", "rest_length", "rest_angle", "stretch", "shear", "bend")
NUMBERS = ("bias", "weight", "values", "place", "angle", "curl", "stiffness")
"""Genes that a creature file holds as Base64."""
PARTS = ("measured", "provenance", "licence", "credit")
ATTRIBUTES = {"format", "sha256", *PARTS}


def dump(file: Mapping[str, Any]) -> bytes:
    """Return the bytes of a parsed creature file; the same file gives the same bytes."""
    return hdf5.dump(_tree(file), _attributes(file))


def _attributes(file: Mapping[str, Any]) -> dict[str, str]:
    texts = {part: json.dumps(file[part], sort_keys=True) for part in PARTS}
    return {"format": FORMAT, "sha256": file["sha256"], **texts}


def _tree(file: Mapping[str, Any]) -> dict[str, Any]:
    body = Identity.model_validate(file["identity"]).shape
    measured = file["measured"]
    tree: dict[str, Any] = {
        "identity": np.bytes_(canonical(file["identity"])),
        "body": {name: getattr(body, name) for name in BODY},
        "genome": _arrays(file["identity"]["genome"]),
    }
    if measured:
        tree["measured"] = {
            "fitness": measured["fitness"],
            **{
                group: {link(name): value for name, value in measured[group].items()}
                for group in ("descriptors", "measures")
            },
        }
    return tree


def load(data: bytes) -> dict[str, Any]:
    """Return the creature file in these bytes, checked as any other.

    Raises `ValueError` where it is none. The file must equal what `dump` writes: other readers
    would trust arrays that differ from the identity. Nothing outside the file may be read.
    """
    try:
        with h5py.File(BytesIO(data), "r") as file:
            texts = hdf5_guard.texts(file, ATTRIBUTES)
            if texts["format"] != FORMAT:
                raise InvalidField("format", f"must be {FORMAT}, got {texts['format']:.60}")
            parts = {part: json.loads(texts[part]) for part in PARTS}
            identity = json.loads(hdf5_guard.text(file, "identity"))
            found = parse({"identity": identity, "sha256": texts["sha256"], **parts})
            hdf5_guard.refuse_other(file, _tree(found))
    except (OSError, RuntimeError, KeyError, TypeError, RecursionError) as error:
        raise ValueError(f"a creature's HDF5 file must be HDF5: {error}") from error
    expected = _attributes(found)
    if wrong := [name for name in texts if texts[name] != expected[name]]:
        raise ValueError(f"attributes must be as they are written here, got other {wrong}")
    return found


def is_of_run(data: bytes) -> bool:
    """Return whether the bytes are the file of a run, which is HDF5 of another `format`."""
    if not data.startswith(hdf5.HDF5):
        return False
    try:
        hdf5.load(data, FORMAT, only=())
    except ValueError:
        return True
    return False


def read(data: bytes) -> dict[str, Any]:
    """Return the checked creature file in these bytes, which are JSON or HDF5.

    Raises `ValueError` for anything else.
    """
    if not data.startswith(hdf5.HDF5):
        return parse(data)
    try:
        return load(data)
    except CreatureError:
        raise
    except ValueError as error:
        raise ValueError(f"a creature is needed, as JSON or HDF5: {error}") from error


def link(name: str) -> str:
    """Return a name for HDF5: path characters are percent-encoded, an empty one is `%`."""
    return re.sub("[%/.\0]", lambda found: f"%{ord(found[0]):02X}", name) or "%"


def _arrays(genome: Mapping[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in genome.items():
        if name in NUMBERS and isinstance(value, str):
            found[name] = decode(value)
        elif isinstance(value, list | tuple):
            text = any(isinstance(item, str) for item in value)
            found[name] = np.array([v.encode() for v in value]) if text else np.array(value)
        elif name in ("nodes", "connections", "plan"):
            found[name] = _arrays(value)
    return found
