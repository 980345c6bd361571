"""QDax's CMA-ME emitters in our search, beside iso+line; the result as QDax's repertoire.

Needs `pip install "microcosmos[qdax]"`.
"""

from pathlib import Path
from typing import Any

import jax.numpy as jnp

import microcosmos

SPEC = {
    "experiment": "quality-diversity",
    "world": {"width": 32, "height": 32},
    "body": {"nodes": 12},
    "control": {"encoding": "direct", "period": 50},
    "task": {"steps": 100},
    "archive": {
        "descriptors": [{"name": "bending_effort"}, {"name": "stretching_effort"}],
        "centroids": 256,
    },
    "search": {
        "generations": 20,
        "batch": 32,
        "emitters": [{"operator": "cma-me", "emitters": 2}, {"operator": "iso+line"}],
    },
}


def main(path: Path = Path("cma-me.h5"), **changes: Any) -> Any:
    """Evolve into an archive file, and read that as a repertoire."""
    microcosmos.prepare()
    spec = microcosmos.parse(SPEC | changes)
    microcosmos.evolve(spec, path, tell=lambda report: print(report.summary))
    repertoire = microcosmos.to_repertoire(path)
    fitness = repertoire.fitnesses[:, 0]
    print(
        f"{int(jnp.sum(jnp.isfinite(fitness)))} elites; best {float(fitness.max()):.3f} cells"
    )
    return repertoire


if __name__ == "__main__":
    main()
