"""The exchange file: a NumPy archive of `nodes`, `conns`, `fitness` and `meta` (JSON text)."""

import json
import zlib
from collections.abc import Mapping
from io import BytesIO
from math import prod
from typing import Any
from zipfile import BadZipFile, LargeZipFile, ZipFile

import numpy as np

from .network import Network
from .reading import read_tensorneat
from .writing import Genome

MEMBERS = ("nodes.npy", "conns.npy", "fitness.npy", "meta.npy")
LARGEST = 64 * 2**20
"""Most bytes of an array, so that a small file cannot ask for all memory."""


def dump_tensorneat(genome: Genome, fitness: float = float("nan")) -> bytes:
    """Write a genome as TensorNEAT saves one, with its names beside it."""
    stream, meta, value = BytesIO(), np.array(json.dumps(genome.meta)), np.float32(fitness)
    np.savez(stream, nodes=genome.nodes, conns=genome.conns, fitness=value, meta=meta)
    return stream.getvalue()


def load_tensorneat(
    data: bytes, meta: Mapping[str, Any] | None = None
) -> tuple[Network, float]:
    """Return the network in a file, and its fitness or NaN. Raises `ValueError` if invalid.

    A file that TensorNEAT itself wrote holds no names: give them as `meta`.
    """
    arrays = _arrays(data)
    names = _meta(arrays) if meta is None else meta
    for name in ("nodes", "conns"):
        if name not in arrays:
            raise ValueError(f"the file must hold `{name}`, got {sorted(arrays)}")
    fitness = arrays.get("fitness", np.array(np.nan))
    if fitness.size != 1 or fitness.dtype.kind not in "fiu":
        raise ValueError(f"`fitness` must be one number, got {fitness.dtype}{fitness.shape}")
    network = read_tensorneat(arrays["nodes"], arrays["conns"], names)
    return network, float(fitness.reshape(()))


def _meta(arrays: Mapping[str, np.ndarray]) -> Any:
    if "meta" not in arrays:
        raise ValueError(
            f"the file must hold `meta`, or its names must be given; got {sorted(arrays)}"
        )
    try:
        return json.loads(str(arrays["meta"]))
    except (ValueError, RecursionError) as error:
        raise ValueError(f"`meta` must be JSON, got {str(arrays['meta'])!r:.60}") from error


def _arrays(data: bytes) -> dict[str, np.ndarray]:
    try:
        with ZipFile(BytesIO(data)) as file:
            names = file.namelist()
            if not set(names) <= set(MEMBERS) or len(names) > len(MEMBERS):
                needed = ", ".join(MEMBERS)
                raise ValueError(f"the file must hold {needed} alone, got {names[:8]}")
            return {name.removesuffix(".npy"): _array(name, file) for name in names}
    except (BadZipFile, LargeZipFile, EOFError, OSError, RuntimeError, zlib.error) as error:
        raise ValueError(f"a genome must be a NumPy archive (.npz), got {error}") from error


def _array(name: str, file: ZipFile) -> np.ndarray:
    """Read one array; its header must fit the bytes before memory is allocated."""
    with file.open(name) as member:
        data = member.read(LARGEST + 1)
    if len(data) > LARGEST:
        raise ValueError(f"`{name}` must be at most {LARGEST:,} bytes, got more")
    stream = BytesIO(data)
    version = np.lib.format.read_magic(stream)
    if version != (1, 0):
        raise ValueError(f"`{name}` must be of NumPy's format 1.0, got {version}")
    shape, fortran, dtype = np.lib.format.read_array_header_1_0(stream)
    rest = data[stream.tell() :]
    if dtype.hasobject or prod(shape) * dtype.itemsize != len(rest) or not rest:
        raise ValueError(f"`{name}` must hold {shape} of {dtype}, got {len(rest)} bytes")
    return np.frombuffer(rest, dtype).reshape(shape, order="F" if fortran else "C")
