"""Precision, strict broadcasting, checked shapes and creatures for tests of the engine.

Most of their time is XLA's, which compiles hundreds of programs that run once: it may do that
without optimising. What is marked `optimised` is about the very bits that come out, and
`make test` runs it with MICROCOSMOS_TEST_OPTIMISED set, as the product compiles.
"""

import hashlib
import os
import platform
from pathlib import Path

QUICK = (
    "--xla_backend_optimization_level=0 --xla_cpu_use_fusion_emitters=false "
    "--xla_cpu_parallel_codegen_split_count=1"
)
"""Compiles in a fifth of the time."""
if "MICROCOSMOS_TEST_OPTIMISED" not in os.environ:
    os.environ["XLA_FLAGS"] = f"{os.environ.get('XLA_FLAGS', '')} {QUICK}".strip()

import jax  # noqa: E402
import jax.numpy as jnp  # noqa: E402
import numpy as np  # noqa: E402
import pytest  # noqa: E402
from jaxtyping import install_import_hook  # noqa: E402


def compiled() -> str:
    """The folder of compiled programs: one for each kind of processor that the checkout meets.

    JAX's own key has the flags and versions, not the instructions that the processor knows.
    """
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else [platform.processor()]
    kind = {line for line in lines if line.startswith(("model name", "flags", "Features"))}
    digest = hashlib.sha256(" ".join([platform.machine(), *sorted(kind)]).encode()).hexdigest()
    return str(Path(__file__).parents[2] / ".cache" / "jax" / digest[:12])


CACHE = "MICROCOSMOS_TEST_COMPILED"
os.environ.setdefault(CACHE, compiled())  # Tests that start processes tell them.
jax.config.update("jax_compilation_cache_dir", os.environ[CACHE])
# Small programs too: there are many, and each process and each new lambda would compile them.
jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)
jax.config.update("jax_persistent_cache_min_entry_size_bytes", -1)

SHAPED = (
    "bodies",
    "coupling",
    "fields",
    "filaments",
    "fluid",
    "groups",
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
