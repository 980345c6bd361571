"""An archive as a table, in the columns of pyribs' `ArchiveDataFrame`."""

import csv as csv_module
import json
from io import StringIO

import numpy as np

from .file import load


def csv(data: bytes) -> str:
    """One row for each elite: `solution_i`, `objective`, `measures_i`, `threshold`, features,
    `generation`, `creature`, `index`.

    A solution is the genome's arrays side by side, in the order of their names; a measure
    is on its axis' own scale, so that bins of a log axis are equally wide.
    """
    tree, attributes = load(data)
    archive = tree["archive"]
    genomes = archive["genomes"]
    solution = np.concatenate([genomes[name].astype(float) for name in sorted(genomes)], axis=1)
    axes = json.loads(attributes["spec"])["archive"]["descriptors"]
    features = json.loads(attributes["features"])
    measures = [_scaled(archive["features"][:, features.index(a["name"])], a) for a in axes]
    fitness = archive["fitness"]
    columns = {f"solution_{i}": solution[:, i] for i in range(solution.shape[1])}
    columns |= {"objective": fitness}
    columns |= {f"measures_{i}": values for i, values in enumerate(measures)}
    columns |= {"threshold": fitness}
    columns |= {name: archive["features"][:, i] for i, name in enumerate(features)}
    columns |= {"generation": archive["generation"]}
    columns |= {"creature": [bytes(row).hex() for row in archive["creature"]]}
    columns |= {"index": archive["cell"]}
    text = StringIO()
    writer = csv_module.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(list(column) for column in columns.values()), strict=True))
    return text.getvalue()


def _scaled(values: np.ndarray, axis: dict) -> np.ndarray:
    values = np.clip(values, axis["low"], axis["high"])
    return np.log10(values) if axis["scale"] == "log10" else values
