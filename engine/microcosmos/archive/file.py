"""HDF5 files as bytes: nested arrays and attributes, the same content giving the same bytes."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import h5py
import numpy as np

FORMAT = "microcosmos-archive/1"
HDF5 = b"\x89HDF\r\n\x1a\n"
"""The first bytes of every HDF5 file."""


class Tree(dict[str, Any]):
    """Arrays and groups of a file by name; `ValueError` for a name that is missing."""

    def __missing__(self, name: str) -> Any:
        raise ValueError(f"the file must hold {name!r}, which is not there")


def dump(tree: Mapping[str, Any], attributes: Mapping[str, str]) -> bytes:
    """Return a file with a group per mapping and a dataset per array, in sorted order.

    It holds neither names nor times of a machine.
    """
    with h5py.File.in_memory(libver=("v110", "v110"), track_order=False) as file:
        for name in sorted(attributes):
            # Fixed-length bytes: variable-length text would live in a heap.
            file.attrs[name] = np.bytes_(attributes[name].encode())
        _write(file, tree)
        file.flush()
        return file.id.get_file_image()


def load(
    data: bytes, wanted: str = FORMAT, only: Sequence[str] | None = None
) -> tuple[Tree, Tree]:
    """Return the arrays and attributes of our file; `only` names the groups to read. Raises
    `ValueError` for any other format than the wanted one."""
    try:
        with h5py.File(BytesIO(data), "r") as file:
            attributes = Tree({n: bytes(x).decode() for n, x in file.attrs.items()})
            tree = _read(file, only)
    except OSError as error:
        raise ValueError(f"an archive file must be HDF5: {error}") from error
    if attributes.get("format") != wanted:
        raise ValueError(f"`format` must be {wanted}, got {attributes.get('format')}")
    return tree, attributes


def _write(group: h5py.Group, tree: Mapping[str, Any]) -> None:
    for name in sorted(tree):
        if isinstance(tree[name], Mapping):
            _write(group.create_group(name), tree[name])
        else:
            group.create_dataset(name, data=np.asarray(tree[name]), track_times=False)


def _read(group: h5py.Group, only: Sequence[str] | None = None) -> Tree:
    items = [(n, x) for n, x in group.items() if only is None or n in only]
    return Tree({n: _read(x) if isinstance(x, h5py.Group) else x[()] for n, x in items})


@dataclass(frozen=True)
class Table:
    """Rows of flat values, and their kind of experiment."""

    experiment: str
    rows: list[dict[str, Any]]


def read_table(data: bytes) -> Table:
    """Return the table in a run's file. Raises `ValueError` if it has none."""
    tree, attributes = load(data)
    loop = tree.get("loop", {})
    if "rows" not in loop:
        raise ValueError(
            "a table is needed, as sweeps, measurements and foldings have; got an archive"
        )
    experiment = json.loads(attributes["spec"])["experiment"]
    return Table(experiment, json.loads(bytes(loop["rows"])))
