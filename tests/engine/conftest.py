"""Precision, strict broadcasting, checked shapes and creatures for tests of the engine.

Most of their time is XLA's, which compiles hundreds of programs that run once: it may do that
without optimising. What is marked `optimised` is about the very bits that come out, or computes
for long; the Makefile runs it with MICROCOSMOS_TEST_OPTIMISED set, as the product compiles.
"""

import gc
import hashlib
import json
import os
import platform
import signal
import struct
from pathlib import Path

QUICK = (
    "--xla_backend_optimization_level=0 --xla_cpu_use_fusion_emitters=false "
    "--xla_cpu_parallel_codegen_split_count=1"
)
"""Compiles in a fifth of the time."""
if "MICROCOSMOS_TEST_OPTIMISED" not in os.environ:
    os.environ["XLA_FLAGS"] = f"{os.environ.get('XLA_FLAGS', '')} {QUICK}".strip()

# JAX makes objects by the million, nearly all of which live on: looking for garbage as often as
# Python does by default takes a tenth of the time.
gc.set_threshold(100_000, 50, 100)

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

SHAPED = "bodies coupling fields filaments fluid genomes groups neat search world"
CHECKED = [f"microcosmos.{name}" for name in SHAPED.split()]
install_import_hook(CHECKED, "beartype.beartype")
jax.config.update("jax_numpy_rank_promotion", "raise")

import genotypes  # noqa: E402
from typer.testing import CliRunner  # noqa: E402

from microcosmos import cli, device, spec, world  # noqa: E402
from microcosmos.archive import creature  # noqa: E402
from microcosmos.build import build, build_world  # noqa: E402


@pytest.fixture
def float64():
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

    def put(body, dtype, *, viscosity, size=(64, 64), fluid=True, **coupling):
        place = spec.World(width=size[0], height=size[1], viscosity=viscosity, fluid=fluid)
        box = build_world(place, spec.Coupling(**coupling), body, dtype)
        positions = body.positions - body.positions.mean(0) + np.array(size) / 2
        return box, jax.jit(world.at_rest)(box, device.array(positions, dtype))

    return put


@pytest.fixture(scope="session")
def require_slope():
    """A function that compares a gradient with central differences along random directions.

    Other directions can be given. The slope along the last one is returned.
    """

    def compare(value, inputs, *, h=1e-6, rtol=1e-6, seed=0, directions=()):
        random = np.random.default_rng(seed)
        inputs = jax.tree.map(np.asarray, inputs)
        both = jax.jit(jax.value_and_grad(value))
        gradient = jax.device_get(both(inputs)[1])
        anywhere = jax.tree.map(lambda x: random.normal(size=x.shape), inputs)
        for along in directions or [anywhere]:
            ahead, behind = (
                both(jax.tree.map(lambda x, d, s=step: x + s * d, inputs, along))[0]
                for step in (h, -h)
            )
            products = jax.tree.map(lambda g, d: np.sum(g * d), gradient, along)
            slope = sum(jax.tree.leaves(products))
            np.testing.assert_allclose(slope, (ahead - behind) / (2 * h), rtol=rtol)
        return slope

    return compare


@pytest.fixture(scope="session")
def network_of():
    """A function that makes a CPPN from its links, activations and biases."""
    return genotypes.network_of


@pytest.fixture(scope="session")
def best_of():
    """A function that gives the best creature of one generation of a search."""

    def find(batch, **parts):
        search = {"generations": 1, "batch": batch, "block": batch}
        document = {"experiment": "quality-diversity", "search": search, **parts}
        experiment = build(spec.parse(document))
        return experiment.best(experiment.advance(experiment.init())[0])

    return find


@pytest.fixture(scope="session")
def newcomer(best_of):
    parts = {"world": {"width": 32, "height": 32}, "body": {"nodes": 8}}
    return creature.parse(
        best_of(
            2, **parts, control={"period": 20}, task={"steps": 40, "fitness": "displacement"}
        )
    )


@pytest.fixture(scope="session")
def carry_out():
    """A function that gives states and reports of a whole run, the initial state first."""

    def run(experiment):
        states, reports = [experiment.init()], []
        while not experiment.done(states[-1]):
            state, report = experiment.advance(states[-1])
            states.append(state)
            reports.append(report)
        return states, reports

    return run


@pytest.fixture(scope="session")
def replay_bytes():
    """A function that writes a replay of positions, edges and vorticity levels, all else 0."""

    def write(positions, edges, levels, /, scale=0.01, **change):
        frames, nodes, _ = positions.shape
        header = {
            "format": "microcosmos-replay/2",
            "frames": frames,
            "every": 5,
            "nodes": nodes,
            "edges": edges,
            "joints": [],
            "size": list(levels.shape[1:]),
            "vorticity": {"scale": scale},
            "velocity": {"scale": 1.0},
            "energy": {"scale": 1.0, "frames": 0},
        }
        text = json.dumps(header | change).encode()
        text += b" " * (-len(text) % 4)
        arrays = (
            positions.astype("<f4"),
            np.zeros((frames, len(edges)), "<f4"),
            levels.astype(np.int8),
            np.zeros((frames, 2, *levels.shape[1:]), np.int8),
        )
        return struct.pack("<I", len(text)) + text + b"".join(x.tobytes() for x in arrays)

    return write


@pytest.fixture
def invoke(tmp_path, monkeypatch):
    """A function that runs a command in this process and returns its output on one line.

    The working folder is empty; signal handlers and JAX stay as the tests have them.
    """
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "1000")
    monkeypatch.setattr("microcosmos.device.prepare", lambda **_: None)
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}

    def run(*arguments, code=0):
        done = CliRunner().invoke(cli.app, [str(argument) for argument in arguments])
        assert done.exit_code == code, done.output
        return " ".join(done.output.split())

    yield run
    for number, handler in before.items():
        signal.signal(number, handler)
