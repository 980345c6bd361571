"""Searches whose emitters learn are taken up bit for bit, those of peers among them."""

import importlib.util

import jax
import numpy as np
import pytest

from microcosmos.build import build
from microcosmos.spec import parse

TINY = {
    "seed": 2,
    "world": {"width": 32, "height": 32},
    "body": {"nodes": 8},
    "task": {"steps": 20},
    "search": {"generations": 5, "batch": 8, "block": 4},
}
NUMBERS = {"experiment": "quality-diversity", "control": {"encoding": "direct", "period": 20}}
SEARCHED = {"experiment": "quality-diversity", "control": {"period": 20}}
NETWORKS = {"experiment": "neuroevolution", "control": {"period": 20}}

SEARCHES = {
    "cma-mae": (None, NUMBERS, {"operator": "cma-mae"}),
    "cma-mega": (None, NUMBERS, {"operator": "cma-mega"}),
    "lamarckian": (None, SEARCHED, {"operator": "lamarckian", "lessons": 1}),
    "cma-me": ("qdax", NUMBERS, {"operator": "cma-me", "emitters": 2}),
    "tensorneat": ("tensorneat", NETWORKS, {"backend": "tensorneat", "preset": "tensorneat"}),
}


@pytest.fixture(params=SEARCHES)
def experiment(request):
    """A search of each kind; skipped where the package that it needs is missing."""
    package, whole, emitter = SEARCHES[request.param]
    if package and importlib.util.find_spec(package) is None:
        pytest.skip(f"{package} is not installed: make peers, make tensorneat")
    own = TINY | whole
    if "operator" in emitter:
        own |= {"search": {**TINY["search"], "emitters": [emitter]}}
    else:
        own |= {"neat": emitter}
    with jax.numpy_rank_promotion("allow" if package else "raise"):
        yield build(parse(own))


@pytest.mark.filterwarnings("ignore")
def test_a_run_taken_up_from_its_file_ends_with_the_same_bytes(experiment, carry_out, finish):
    states, reports = carry_out(experiment)
    state = states[-1]
    again = experiment.restore(experiment.save(states[2]))
    assert finish(experiment, again) == experiment.save(state)
    assert np.asarray(state.elites.occupied).sum() > 1
    taught = {"cma-mega": 5, "lamarckian": 40}.get(experiment.plan.names[0], 0)
    assert state.evaluations == 40 + taught
    if taught:
        assert reports[-1].summary["slopes: sound"] == 1
        assert reports[-1].summary["slopes: length"] > 0
