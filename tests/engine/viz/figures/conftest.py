"""Archives that tests of figures make up."""

import numpy as np
import pytest

from microcosmos import spec
from microcosmos.measures import RECORDED
from microcosmos.viz.figures.reading import Archive

DEVICE = "cpu, A Model avx2, microcosmos 0, jax 0, jaxlib 0"
AXES = ({"name": "bending_effort", "bins": 4}, {"name": "straightness", "bins": 5})


@pytest.fixture
def made():
    def make(
        elites,
        *,
        axes=AXES,
        centroids=None,
        container=None,
        best=(1.0, 2.0),
        lineage=None,
        **more,
    ):
        cells = {"container": container}
        cells |= {} if centroids is None else {"centroids": len(centroids)}
        document = {"experiment": "quality-diversity", **more}
        document["archive"] = {"descriptors": axes, **cells}
        curves = {
            "best": np.array(best, float),
            "coverage": np.linspace(0.1, 0.5, len(best)),
            "qd_score": np.cumsum(best),
            "evaluations": 16.0 * np.arange(1, len(best) + 1),
        }
        return Archive(
            spec=spec.parse(document),
            version="0.1.0",
            devices=(DEVICE,),
            measures={
                n: np.array([e.get(n, 0.5) for e in elites])
                for n in [*RECORDED, *(axis["name"] for axis in axes)]
            },
            cells=np.array([elite["cell"] for elite in elites]),
            fitness=np.array([elite["fitness"] for elite in elites], float),
            centroids=None if centroids is None else np.array(centroids, np.float32),
            curves=curves,
            lineage=lineage or {"parents": np.zeros((len(elites), 2, 32), np.uint8)},
        )

    return make
