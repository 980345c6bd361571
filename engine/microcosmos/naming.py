"""Canonical bytes and names of creatures: JSON by RFC 8785, SHA-256, arrays as base64."""

from base64 import b64decode, b64encode
from collections.abc import Iterable, Mapping
from hashlib import sha256
from typing import Any

import numpy as np
import rfc8785

from .version import VERSION

FORMAT = "microcosmos-creature/1"
LICENCE = "CC-BY-4.0"
ACTIVATIONS = ("identity", "sigmoid", "tanh", "relu", "sin", "cos", "gaussian", "abs", "square")
"""Activations, in the order of their numbers in genomes."""


def encode(values: np.ndarray) -> str:
    """Encode values as little-endian float32 in base64, with −0 as 0."""
    # −0 + 0 is 0: equal genes must have equal bytes, and so one name.
    return b64encode((np.asarray(values, "<f4") + np.float32(0)).tobytes()).decode()


def decode(text: str) -> np.ndarray:
    """Decode float32 values in base64; raise `ValueError` for anything else."""
    data = b64decode(text, validate=True)
    if len(data) % 4:
        raise ValueError(f"needs whole float32 values, got {len(data)} bytes")
    values = np.frombuffer(data, "<f4")
    if not np.all(np.isfinite(values)):
        raise ValueError("needs finite values, got NaN or infinity")
    # One creature has one name: other texts of the same numbers are refused.
    if encode(values) != text:
        raise ValueError("needs the canonical encoding, got another (write −0 as 0)")
    return values


def decoded(columns: Mapping[str, Any]) -> dict[str, Any]:
    """Return columns of a creature file, with those in base64 decoded."""
    return {n: decode(x) if isinstance(x, str) else x for n, x in columns.items()}


def canonical(identity: Mapping[str, Any]) -> bytes:
    """Return the canonical JSON (RFC 8785), whose SHA-256 is the name."""
    return rfc8785.dumps(dict(identity))


def name(identity: Mapping[str, Any]) -> str:
    """Return the SHA-256 of the canonical form, in hexadecimal."""
    return sha256(canonical(identity)).hexdigest()


def document(
    identity: Mapping[str, Any],
    measured: Mapping[str, Any] | None,
    provenance: Mapping[str, Any] | None,
) -> dict[str, Any]:
    """Return the creature file around an identity."""
    return {
        "identity": dict(identity),
        "sha256": name(identity),
        "measured": dict(measured) if measured else None,
        "provenance": dict(provenance) if provenance else None,
        "licence": LICENCE,
        "credit": [],
    }


def provenance(
    operator: str, *, generation: int = 0, parents: Iterable[str] = (), seed: int = 0
) -> dict[str, Any]:
    """Return the provenance of a creature made by this version."""
    return {
        "parents": list(parents),
        "operator": operator,
        "generation": generation,
        "seed": seed,
        "version": VERSION,
    }
