"""Columns as bytes: a JSON header, then one little-endian array after another."""

import json
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np

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
        raise ValueError(f"`format` of columns must be {FORMAT!r}, got {found!r}")
    start, columns = LENGTH.size + length, {}
    for one in described:
        kind = np.dtype(one["type"]).newbyteorder("<")
        count = int(np.prod(one["shape"], dtype=int))
        if start + count * kind.itemsize > len(content):
            raise ValueError(f"column {one['name']!r} ends after the {len(content)} bytes")
        values = np.frombuffer(content, kind, count, start).reshape(one["shape"])
        columns[one["name"]] = values.astype(kind.newbyteorder("="), copy=False)
        start += count * kind.itemsize
        start += -start % ALIGNMENT
    return header, columns
