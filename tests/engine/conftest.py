"""Precision, strict broadcasting, checked shapes and creatures for tests of the engine."""

import atexit
import os
import shutil
import tempfile

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jaxtyping import install_import_hook

CACHE = "MICROCOSMOS_TEST_COMPILED"
if CACHE not in os.environ:  # The processes that share the tests find the first one's.
    os.environ[CACHE] = tempfile.mkdtemp(prefix="microcosmos-compiled-")
    atexit.register(shutil.rmtree, os.environ[CACHE], ignore_errors=True)
jax.config.update("jax_compilation_cache_dir", os.environ[CACHE])

SHAPED = (
    "bodies",
    "coupling",
    "fields",
    "filaments",
    "fluid",
    "groups",
    "creatures",
    "world",
    "genomes",
    "neat",
    "search",
)

install_import_hook([f"microcosmos.{name}" for name in SHAPED], "beartype.beartype")
jax.config.update("jax_numpy_rank_promotion", "raise")

from microcosmos import bodies, filaments, spec, world  # noqa: E402
from microcosmos.build import build_world  # noqa: E402


@pytest.fixture
def float64():
    """JAX computes in float64."""
    with jax.enable_x64(True):
        yield jnp.dtype("float64")


@pytest.fixture(params=["float32", "float64"])
def dtype(request):
    """The test runs in both precisions, each with JAX set up for it."""
    with jax.enable_x64(request.param == "float64"):
        yield jnp.dtype(request.param)


@pytest.fixture
def immerse():
    """A function that puts a body at rest in the middle of a fluid at rest."""

    def put(body, dtype, *, viscosity, size=(64, 64), magic="capped", **coupling):
        place = spec.World(width=size[0], height=size[1], viscosity=viscosity, magic=magic)
        box = build_world(place, spec.Coupling(**coupling), body, dtype)
        positions = body.positions - body.positions.mean(0) + np.array(size) / 2
        return box, world.at_rest(box, jnp.asarray(positions, dtype))

    return put


@pytest.fixture
def chain():
    """A function that makes a straight filament with nodes one cell apart."""

    def straight(nodes):
        return bodies.chain(nodes, 1.0)

    return straight


@pytest.fixture
def ring():
    """A function that makes a closed filament with nodes one cell apart."""

    def closed(nodes):
        return bodies.ring(nodes, 1.0)

    return closed


@pytest.fixture
def erratic():
    """A function that draws large rest angles and lengths anew every 20 steps."""

    def gait(body, steps, dtype, seed=0):
        random = np.random.default_rng(seed)
        draws = -(-steps // 20)
        turn = random.uniform(-1, 1, (draws, len(body.joints)))
        change = random.uniform(-0.3, 0.3, (draws, len(body.edges)))
        rest = _rest(body, turn, dtype, change)
        return jax.tree.map(lambda x: jnp.repeat(x, 20, 0)[:steps], rest)

    return gait


def _rest(body, turn, dtype, change=0.0):
    """Rest shapes over time: `turn` added to angles, lengths stretched by `change`."""
    length = body.rest_length[None] * (1 + change * np.ones((len(turn), len(body.edges))))
    return filaments.Rest(
        jnp.asarray(body.rest_angle[None] + turn, dtype), jnp.asarray(length, dtype)
    )
