"""Safe reading of untrusted HDF5: only expected items, only from the file itself."""

from collections.abc import Mapping
from itertools import islice
from typing import Any

import h5py
import numpy as np

from ..invalid import InvalidField

MAX_TEXT_BYTES = 8 << 20
"""Maximum number of bytes of a text."""
PLAIN_LAYOUTS = (h5py.h5d.CONTIGUOUS, h5py.h5d.COMPACT)
TOLERANCE = 1e-6
"""Relative tolerance of numbers that another machine has computed."""


def texts(item: Any, names: set[str]) -> dict[str, str]:
    """Return the attributes of an object; they must be texts with exactly these names."""
    found = set(islice(item.attrs, len(names) + 1))
    if found != names:
        raise ValueError(f"attributes must be {sorted(names)}, got {_few(found)}")
    return {name: _text(item.attrs.get_id(name), f"attribute {name}") for name in names}


def text(group: h5py.Group, name: str) -> str:
    """Return the text in a dataset."""
    dataset = own(group, name, name)
    if not isinstance(dataset, h5py.Dataset):
        raise InvalidField(name, "must be a dataset, got a group")
    _refuse_elsewhere(dataset, name)
    return _text(dataset, name)


def refuse_other(group: h5py.Group, tree: Mapping[str, Any], where: str = "") -> None:
    """Raise `ValueError` unless a group holds exactly the arrays of a tree."""
    found = set(islice(group, len(tree) + 1))
    if found != set(tree):
        raise InvalidField(f"{where or '/'}", f"must hold {sorted(tree)}, got {_few(found)}")
    for name, expected in tree.items():
        place = f"{where}/{name}"
        item, inside = own(group, name, place), isinstance(expected, Mapping)
        if isinstance(item, h5py.Group) != inside:
            kind = "group" if inside else "dataset"
            raise InvalidField(place, f"must be a {kind}, got something else")
        if isinstance(expected, Mapping):
            refuse_other(item, expected, place)
        else:
            _refuse_unequal(item, np.asarray(expected), place)


def own(group: h5py.Group, name: str, place: str) -> Any:
    """Return a named item; raise `ValueError` if it is a soft or external link."""
    link = group.get(name, getlink=True)
    if not isinstance(link, h5py.HardLink):
        kind = type(link).__name__ if link else "nothing"
        raise InvalidField(place, f"must lie in the file itself, got {kind}")
    return group[name]


def refuse_outside(dataset: h5py.Dataset, place: str) -> None:
    """Raise `ValueError` for an array that lies in another file."""
    if dataset.id.get_create_plist().get_external_count():
        raise InvalidField(place, "must be stored in the file, got external storage")
    if dataset.is_virtual:
        raise InvalidField(place, "must be stored in the file, got a virtual dataset")


def _refuse_elsewhere(dataset: h5py.Dataset, place: str) -> None:
    """Refuse external storage and filters: reading must not exceed the file's size."""
    refuse_outside(dataset, place)
    layout = dataset.id.get_create_plist()
    if layout.get_layout() not in PLAIN_LAYOUTS or layout.get_nfilters():
        raise InvalidField(place, "must be stored plainly, got chunks or filters")


def _text(item: Any, place: str) -> str:
    """Return a text of fixed length; refuse variable length, which points to a heap."""
    if item.shape != () or item.dtype.kind != "S" or item.dtype.itemsize > MAX_TEXT_BYTES:
        raise InvalidField(place, f"must be one text, got {item.dtype}{item.shape}")
    if isinstance(item, h5py.Dataset):
        return bytes(item[()]).decode()
    value = np.empty((), item.dtype)
    item.read(value)
    return bytes(value[()]).decode()


def _refuse_unequal(dataset: h5py.Dataset, expected: np.ndarray, place: str) -> None:
    _refuse_elsewhere(dataset, place)
    if (dataset.shape, dataset.dtype) != (expected.shape, expected.dtype):
        raise InvalidField(
            place,
            f"must be {expected.dtype}{expected.shape} as the identity has it, "
            f"got {dataset.dtype}{dataset.shape}",
        )
    found = np.asarray(dataset[()])
    floats = expected.dtype.kind == "f"
    # Compare bytes, not values: a boolean of byte 0x41 would equal true.
    same = found.tobytes() == expected.tobytes()
    if not same and not (floats and np.allclose(found, expected, TOLERANCE)):
        raise InvalidField(place, "must be as the identity has it, got other values")


def _few(names: set[str]) -> list[str]:
    return sorted(name[:60] for name in names)[:8]
