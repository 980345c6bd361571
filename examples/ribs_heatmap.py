"""Our archive drawn by pyribs, and as a pandas data frame.

Needs `pip install "ribs[visualize]"`.
"""

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
from ribs.visualize import cvt_archive_heatmap, grid_archive_heatmap

import microcosmos

SPEC = {
    "experiment": "quality-diversity",
    "world": {"width": 32, "height": 32},
    "body": {"nodes": 12},
    "control": {"period": 50},
    "task": {"steps": 100},
    "search": {"generations": 20, "batch": 32},
}


def main(folder: Path = Path(), **changes: Any) -> Path:
    """Evolve, and draw the archive into a PNG file."""
    microcosmos.prepare()
    path = folder / "archive.h5"
    microcosmos.evolve(microcosmos.parse(SPEC | changes), path)
    print(microcosmos.to_pandas(path)[["objective", "measures_0", "measures_1", "index"]])
    return draw(path, folder / "heatmap.png")


def draw(archive: Path, picture: Path) -> Path:
    """The heatmap of an archive file over two descriptors."""
    filled = microcosmos.to_ribs(archive)
    figure, axes = plt.subplots(figsize=(6, 5))
    around = hasattr(filled, "centroids")
    (cvt_archive_heatmap if around else grid_archive_heatmap)(filled, ax=axes)
    figure.savefig(picture)
    plt.close(figure)
    return picture


if __name__ == "__main__":
    main()
