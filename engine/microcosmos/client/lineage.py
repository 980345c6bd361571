"""The lineage in an archive file, with names in place of bytes and numbers."""

import json

import numpy as np

from ..archive.file import load
from .columns import Columns


def entries(data: bytes) -> Columns:
    """Every entry into the archive, in order: `creature`, its `parents`, `operator`,
    `generation`, `cell`, `fitness`, and the `descriptors` by name.

    Raises `ValueError` where the file holds no archive.
    """
    tree, attributes = load(data)
    if "lineage" not in tree:
        raise ValueError("a run that fills an archive is needed for a lineage; got a table")
    lineage = tree["lineage"]
    operators = json.loads(attributes["operators"])
    axes = [axis["name"] for axis in json.loads(attributes["spec"])["archive"]["descriptors"]]
    names = [
        [bytes(parent).hex() for parent in row if parent.any()] for row in lineage["parents"]
    ]
    found = {
        "creature": [bytes(row).hex() for row in lineage["creature"]],
        "parents": _objects(names),
        "operator": [operators[number] for number in lineage["operator"]],
    }
    found |= {name: lineage[name] for name in ("generation", "cell", "fitness")}
    return Columns(found | {axis: lineage["descriptors"][:, i] for i, axis in enumerate(axes)})


def _objects(values: list[list[str]]) -> np.ndarray:
    found = np.empty(len(values), object)
    found[:] = values
    return found
