"""Preparation of the computing device, and its kind.

Results repeat bit for bit on one kind of device; another kind may round differently.
"""

import os
import platform
import warnings
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
from jax.typing import ArrayLike, DTypeLike
from jaxlib.version import __version__ as jaxlib_version

from .version import VERSION

_STARTED = (
    "JAX has started before `microcosmos.prepare()` and keeps its {} devices: call that first, "
    "so that every core works."
)
KERNELS = ("auto", "native", "jax")
"""Choices of the simulator: the native kernel where it can, the kernel alone, JAX alone."""
KERNEL_VARIABLE = "MICROCOSMOS_KERNEL"
PORTABLE = {
    "x86_64": "--xla_cpu_max_isa=AVX --xla_cpu_experimental_ynn_fusion_type=",
    "aarch64": "--xla_backend_extra_options="
    "-aarch64-enable-mcr=false,-scalable-vectorization=off "
    "--xla_cpu_experimental_ynn_fusion_type=",
}
"""Flags by processor. Without fused multiply-adds, wider vectors and sums by a library, XLA's
programs give the same bits on all of these, as the native kernel does. On ARM only LLVM's
machine combiner fuses at XLA's usual level of optimisation, except in vectors of scalable
length (SVE). Programs of x86-64 are slower by a quarter."""
PORTABLE_JAXLIB = ("0.10.2",)
"""Versions with which the flags were tested; XLA ends a process for flags that it lacks."""
QUICK = {"xla_backend_optimization_level": 0, "xla_cpu_use_fusion_emitters": False}
"""Compiler options that save optimisations; results keep their bits (compared on x86-64)."""
GPU_FLAGS = "--xla_gpu_deterministic_ops=true --xla_gpu_autotune_level=0"


def array(values: ArrayLike, dtype: DTypeLike | None = None) -> jax.Array:
    """Return values of the host on the device.

    `jnp.asarray` compiles a program for each shape, unless the type stays as it is.
    """
    on_host = np.asarray(values, dtype)
    kept = jax.dtypes.canonicalize_dtype(on_host.dtype)
    return jnp.asarray(on_host.astype(kept, copy=False), kept)


def prepare(devices: int | None = None, cache: str | os.PathLike | None = None) -> None:
    """Configure JAX for repeatable results; call this before JAX is first used.

    On a CPU, one device per core (or `devices`) gives every core its own block; results do not
    depend on the number, nor, with the native kernel, on the processor. If JAX has started, it
    keeps its devices, with a warning. Compiled programs are cached in
    JAX_COMPILATION_CACHE_DIR, or in `cache`. Raises `ValueError` for a wrong
    MICROCOSMOS_KERNEL.
    """
    kernel()
    jax.config.update("jax_default_matmul_precision", "highest")
    try:
        jax.config.update("jax_num_cpu_devices", devices or cores())
    except RuntimeError:  # JAX has started, and has read its flags and its cores.
        warnings.warn(_STARTED.format(jax.local_device_count()), stacklevel=2)
    else:
        if Path("/proc/driver/nvidia").exists():
            for flag in GPU_FLAGS.split():
                _add_flags(flag)
    if cache and not os.environ.get("JAX_COMPILATION_CACHE_DIR"):
        jax.config.update("jax_compilation_cache_dir", os.fspath(cache))
    # Cache small programs too, so that a resumed run starts within a second.
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)
    jax.config.update("jax_persistent_cache_min_entry_size_bytes", -1)


def _started() -> bool:
    """Return whether JAX has started, after which it no longer reads flags."""
    bridge = import_module("jax._src.xla_bridge")  # JAX has no public name for it.
    return getattr(bridge, "backends_are_initialized", lambda: False)()


def _portable() -> str | None:
    """Return the flags with which programs give the same bits on every processor, if wanted."""
    # A wrong choice is refused by `prepare`: on import it would be a traceback.
    wanted = os.environ.get(KERNEL_VARIABLE) != "jax" and _installed() is not None
    return portable_flags() if wanted else None


def portable_flags() -> str | None:
    """Return the `PORTABLE` flags of this platform; None where they were not compared."""
    machine = platform.machine().replace("AMD64", "x86_64")
    return PORTABLE.get(machine) if jaxlib_version in PORTABLE_JAXLIB else None


def _add_flags(added: str) -> None:
    """Add flags of XLA, unless one of them has been set."""
    flags = os.environ.get("XLA_FLAGS", "")
    chosen, names = ({one.partition("=")[0] for one in all.split()} for all in (flags, added))
    if not chosen & names:
        os.environ["XLA_FLAGS"] = f"{flags} {added}".strip()


def cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def kernel() -> str:
    """Return the choice of MICROCOSMOS_KERNEL; raise `ValueError` unless it is in `KERNELS`."""
    chosen = os.environ.get(KERNEL_VARIABLE) or KERNELS[0]
    if chosen not in KERNELS:
        allowed = ", ".join(KERNELS)
        raise ValueError(f"`{KERNEL_VARIABLE}` must be one of {allowed}, got {chosen!r}")
    return chosen


def kernel_version() -> str | None:
    """Return the native kernel's version; None without it, on a GPU, or if JAX is chosen."""
    if kernel() == "jax" or jax.default_backend() != "cpu":
        return None
    return _installed()


def has_gpu_kernel() -> bool:
    """Return whether the kernel for GPUs simulates the worlds that it covers."""
    return kernel() == "auto" and jax.default_backend() in ("gpu", "cuda")


def _installed() -> str | None:
    try:
        return version("microcosmos-kernels")
    except PackageNotFoundError:
        return None


def device_kind(*, portable: bool = True) -> str:
    """Return platform, model and software, on which the bits of a result depend.

    With the native kernel and `PORTABLE` flags, these are the versions alone, unless programs
    use what the flags do not cover: then `portable` is false.
    """
    device = jax.local_devices()[0]
    model, flags = device.device_kind, set(os.environ.get("XLA_FLAGS", "").split())
    if device.platform == "cpu":
        # With all flags in force bits do not depend on the processor, which is then not named.
        needed = set((portable_flags() or "").split())
        alike = portable and kernel_version() and needed and needed <= flags
        model, flags = ("", flags - needed) if alike else (_processor(), flags)
    software = f"microcosmos {VERSION}, jax {jax.__version__}, jaxlib {jaxlib_version}"
    if kernels := kernel_version():
        software += f", microcosmos-kernels {kernels}"
    if has_gpu_kernel():
        software += ", kernel for GPUs"
    parts = [device.platform, model, software, " ".join(sorted(flags))]
    return ", ".join(part for part in parts if part)


def _processor() -> str:
    """Return the processor's model and widest vector instructions, which affect rounding."""
    info = Path("/proc/cpuinfo")
    if not info.exists():
        return platform.processor() or platform.machine()
    lines = [line.partition(":") for line in info.read_text().splitlines()]
    fields = {name.strip(): value.strip() for name, _, value in lines}
    flags = fields.get("flags", "").split()
    widest = next((f for f in ("avx512f", "avx2", "avx", "sse2") if f in flags), "no vectors")
    return f"{fields.get('model name', platform.machine())} {widest}"


def compiler_options() -> dict[str, object]:
    """Return the compiler options of every simulation program on this device."""
    if jax.default_backend() != "cpu":
        return {}
    # One thread computes a block: splitting its small loops costs more than it gains.
    return {"xla_cpu_multi_thread_eigen": False, "xla_cpu_prefer_vector_width": 512}


def quick_options() -> dict[str, object]:
    """Return the compiler options of programs that are short beside a simulation.

    On x86-64 such programs compile in a third of the time. On ARM they would get fused
    multiply-adds and other bits.
    """
    alike = jax.default_backend() == "cpu" and portable_flags() == PORTABLE["x86_64"]
    return QUICK if alike else {}


# On import, since evaluations must round alike whether or not a process calls `prepare`.
if (_flags := _portable()) and not _started():
    _add_flags(_flags)
