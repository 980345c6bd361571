"""Columns as bytes: a JSON header, then one little-endian array after another."""

import json
import struct
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..invalid import InvalidField

FORMAT = "microcosmos-columns/1"
MEDIA_TYPE = "application/vnd.microcosmos.columns"
ALIGNMENT = 8
"""Every array begins at a multiple of this number of bytes."""
LENGTH = struct.Struct("<I")


def dump(header: Mapping[str, Any], columns: Mapping[str, np.ndarray]) -> bytes:
    """Return the bytes of columns: integers of 8 or 32 bits, or floats of 32 or 64 bits."""
    described = [
        {"name": name, "type": column.dtype.name, "shape": list(column.shape)}
        for name, column in columns.items()
    ]
    document = {"format": FORMAT, **header, "columns": described}
    text = json.dumps(document, allow_nan=False, separators=(",", ":")).encode()
    text += b" " * (-(LENGTH.size + len(text)) % ALIGNMENT)
    parts = [LENGTH.pack(len(text)), text]
    for column in columns.values():
        content = column.astype(column.dtype.newbyteorder("<"), copy=False).tobytes()
        parts += [content, bytes(-len(content) % ALIGNMENT)]
    return b"".join(parts)


def load(content: bytes) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Return header and columns; raise `ValueError` where the bytes are something else."""
    try:
        (length,) = LENGTH.unpack_from(content)
        header = json.loads(content[LENGTH.size : LENGTH.size + length])
        described = header.pop("columns")
        found = header.pop("format")
    except (struct.error, ValueError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"columns must begin with a JSON header; {error}") from error
    if found != FORMAT:
        raise InvalidField("format", f"of columns must be {FORMAT!r}, got {found!r}")
    try:
        return header, _columns(content, LENGTH.size + length, described)
    except (KeyError, TypeError, OverflowError) as error:
        raise ValueError(f"columns must have a name, a type and a shape; {error!r}") from error


def _columns(
    content: bytes, start: int, described: Sequence[Mapping[str, Any]]
) -> dict[str, np.ndarray]:
    found = {}
    for one in described:
        kind = np.dtype(one["type"]).newbyteorder("<")
        count = int(np.prod(one["shape"], dtype=int))
        if not 0 <= count * kind.itemsize <= len(content) - start:
            raise ValueError(
                f"column {one['name']!r} of shape {one['shape']} must lie within the "
                f"{len(content)} bytes"
            )
        values = np.frombuffer(content, kind, count, start).reshape(one["shape"])
        found[one["name"]] = values.astype(kind.newbyteorder("="), copy=False)
        start += count * kind.itemsize
        start += -start % ALIGNMENT
    return found
