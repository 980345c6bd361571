"""The name of a creature, the SHA-256 of its identity, and the document around it."""

from collections.abc import Iterable, Mapping
from hashlib import sha256
from typing import Any

import rfc8785

from ..version import VERSION

FORMAT = "microcosmos-creature/1"
REPLAY_VERSION = 2
"""A replay that was kept in an earlier one is recorded anew when it is wanted."""
REPLAY_FORMAT = f"microcosmos-replay/{REPLAY_VERSION}"
LICENCE = "CC-BY-4.0"
HDF5 = b"\x89HDF\r\n\x1a\n"
"""How an HDF5 file begins."""


def canonical(identity: Mapping[str, Any]) -> bytes:
    """The bytes that the name is computed over: RFC 8785."""
    return rfc8785.dumps(dict(identity))


def name(identity: Mapping[str, Any]) -> str:
    """The SHA-256 of the canonical form, in hexadecimal."""
    return sha256(canonical(identity)).hexdigest()


def document(
    identity: Mapping[str, Any],
    measured: Mapping[str, Any] | None,
    provenance: Mapping[str, Any] | None,
) -> dict[str, Any]:
    """The creature file around an identity."""
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
    """How a creature came to be, in this version."""
    return {
        "parents": list(parents),
        "operator": operator,
        "generation": generation,
        "seed": seed,
        "version": VERSION,
    }
