"""Choose creatures for a tank that has none: `python web/scripts/examples.py ARCHIVE`.

They are the fittest elites of regions of the archive's first two axes that pass the audit.
Writes their creature files and pose streams to `web/src/tank/examples`.
"""

import json
import sys
from pathlib import Path

from rich.progress import track

from microcosmos.archive import poses
from microcosmos.archive.export import pose_streams
from microcosmos.audit import audit
from microcosmos.build import build
from microcosmos.device import prepare
from microcosmos.experiments.evolution import Evolution
from microcosmos.viz.figures import reading, sheet

FOLDER = Path(__file__).parents[1] / "src" / "tank" / "examples"
COLUMNS, ROWS = 6, 5
SLOWEST = 0.4
"""Of the fittest: slower ones hardly swim."""


def main(path: Path) -> None:
    prepare(cache=Path.home() / ".cache" / "microcosmos")
    data = path.read_bytes()
    found = reading.read(data)
    experiment = build(found.spec)
    assert isinstance(experiment, Evolution)
    state, streams = experiment.restore(data, other_device=True), pose_streams(path)
    axes = [axis.name for axis in found.axes[:2]]
    regions = sheet.layout(found, axes=axes, columns=COLUMNS, rows=ROWS).regions
    files, moving = [], []
    for row in track(sorted((one.elite for one in regions), key=lambda i: -found.fitness[i])):
        if found.fitness[row] < SLOWEST * found.fitness.max():
            continue
        file = experiment.creature(state, int(found.cells[row]))
        if audit(file)["verdict"]["trusted"]:
            files.append(file)
            moving.append(streams[row].encode())
    FOLDER.mkdir(exist_ok=True)
    lines = [json.dumps(file, separators=(",", ":"), sort_keys=True) for file in files]
    (FOLDER / "creatures.json").write_text("[\n" + ",\n".join(lines) + "\n]\n")
    (FOLDER / "motions.poses").write_bytes(poses.batch(moving))
    print(f"{len(files)} creatures")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
