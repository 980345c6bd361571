"""Gradients of creature files, and what is told of them."""

import jax
import numpy as np
import pytest

from microcosmos import spec
from microcosmos.archive import creature
from microcosmos.audit.derivatives import gradient, gradient_health
from microcosmos.build import build_encoding, frame
from microcosmos.experiments.lineage import identity

STEPS = 60
SCENE = {
    "world": {"width": 24, "height": 24, "viscosity": 0.1},
    "body": {"nodes": 8},
    "control": {"encoding": "direct", "period": 30, "terms": 1},
    "task": {"steps": STEPS},
}


@pytest.fixture(scope="module")
def file():
    """A creature that nobody has measured."""
    scene = spec.Scene.model_validate(SCENE)
    encoding = build_encoding(scene, (8, 8))
    newcomer = jax.tree.map(np.asarray, encoding.newcomer(key=jax.random.key(1)))
    return creature.document(identity(frame(scene), newcomer), None, None)


@pytest.mark.long
def test_the_report_agrees_with_finite_differences_and_tells_of_time_and_starts(file):
    report = gradient_health(file, starts=3)
    assert report.errors["float64"] <= 1e-6
    assert report.errors["float32"] <= 1e-2
    assert list(report.norms) == [15, 30, 60]
    assert 0 <= report.sign_agreement <= 1
    assert -1 <= report.cosine <= 1
    assert report.limited == 0


def test_what_a_creature_has_not_is_refused(file):
    with pytest.raises(ValueError, match="`by` must be of"):
        gradient(file, by=("weights",))
