"""HDF5 files as bytes: nested arrays and attributes, the same content giving the same bytes."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import h5py
import numpy as np

from ..invalid import InvalidField
from . import hdf5_guard

FORMAT = "microcosmos-archive/1"
HDF5 = b"\x89HDF\r\n\x1a\n"
"""The first bytes of every HDF5 file."""
MOST_PER_BYTE = 1032
"""Largest number of bytes that DEFLATE, the densest filter of HDF5's own, packs into one. Our
files have no filters, but copies by other programs may."""


class Tree(dict[str, Any]):
    """Arrays and groups of a file by name; `ValueError` for a name that is missing."""

    def __missing__(self, name: str) -> Any:
        raise ValueError(f"the file must hold {name!r}, which is missing")


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
    """Return the arrays and attributes of our file; `only` names the groups to read.

    Raises `ValueError` for any other format than the wanted one, and for arrays that lie in
    another file or are larger than this one can hold.
    """
    try:
        with h5py.File(BytesIO(data), "r") as file:
            attributes = attributes_of(file)
            tree = _read(file, MOST_PER_BYTE * len(data), only)
    # HDF5 finds damage while it opens objects, and h5py raises what it likes.
    except (OSError, RuntimeError, KeyError, TypeError, RecursionError) as error:
        raise ValueError(f"an archive file must be HDF5, undamaged: {error}") from error
    except MemoryError as error:
        raise ValueError(f"an archive file must fit into memory: {error}") from error
    if attributes.get("format") != wanted:
        raise InvalidField("format", f"must be {wanted}, got {attributes.get('format')}")
    return tree, attributes


def attributes_of(file: h5py.File) -> Tree:
    """Return the attributes as text, also those that other programs wrote."""
    return Tree({name: text_of(value) for name, value in file.attrs.items()})


def text_of(value: Any) -> str:
    """Return the text of an attribute."""
    # h5py itself writes text of variable length, which it reads as `str`.
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)


def extents(data: bytes, names: Sequence[str]) -> list[tuple[int, int]]:
    """Return the first byte and the end of each array in a file, of some groups or arrays.

    A name that the file lacks has none, nor have empty arrays.
    """
    found = set[tuple[int, int]]()

    def note(_: str, item: Any) -> None:
        start = item.id.get_offset() if isinstance(item, h5py.Dataset) else None
        if start is not None:
            found.add((start, start + item.id.get_storage_size()))

    with h5py.File(BytesIO(data), "r") as file:
        for name in names:
            if name in file:
                item = file[name]
                note(name, item)
                if isinstance(item, h5py.Group):
                    item.visititems(note)
    return sorted(found)


def words(numbers: np.ndarray, known: Sequence[str]) -> list[str]:
    """Return the words that numbers in a file stand for. Raises `ValueError` for others."""
    found: list[int] = numbers.tolist()
    if wrong := [number for number in found if not 0 <= number < len(known)]:
        raise ValueError(
            f"a number in place of a word must be from 0 to {len(known) - 1}; got {wrong[0]}"
        )
    return [known[number] for number in found]


def _write(group: h5py.Group, tree: Mapping[str, Any]) -> None:
    for name in sorted(tree):
        if isinstance(tree[name], Mapping):
            _write(group.create_group(name), tree[name])
        else:
            group.create_dataset(name, data=np.asarray(tree[name]), track_times=False)


def _read(
    group: h5py.Group, most: int, only: Sequence[str] | None = None, where: str = ""
) -> Tree:
    tree = Tree()
    for name in map(str, group):
        if only is None or name in only:
            place = f"{where}/{name}"
            item = hdf5_guard.own(group, name, place)
            inside = isinstance(item, h5py.Group)
            tree[name] = _read(item, most, None, place) if inside else _array(item, most, place)
    return tree


def _array(item: Any, most: int, place: str) -> Any:
    if not isinstance(item, h5py.Dataset):
        raise InvalidField(place, "must be an array or a group, got a type")
    hdf5_guard.refuse_outside(item, place)
    if item.nbytes > most:
        needed = f"must have at most {most:,} bytes, which a file of this size can hold"
        raise InvalidField(place, f"{needed}; got {item.nbytes:,}")
    return item[()]


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
