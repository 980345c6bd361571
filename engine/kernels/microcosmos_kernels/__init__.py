"""The native kernel: libraries with targets of XLA's foreign function interface.

There is one library for each instruction set; all give the same bits. Nothing here needs JAX.
"""

import ctypes
import os
from importlib.metadata import version
from pathlib import Path

__version__ = version("microcosmos-kernels")

SETS = ("basic", "avx2", "avx512")
"""Instruction sets, the fastest last."""
VARIABLE = "MICROCOSMOS_INSTRUCTION_SET"
"""Environment variable that chooses a set."""


def instruction_sets() -> list[str]:
    """Return the sets that this processor knows and this build has, the fastest last."""
    return [name for name in SETS[: _known() + 1] if _path(name).exists()]


def library(instruction_set: str | None = None) -> Path:
    """Return the library for an instruction set: the fastest, or that of the environment.

    Raises `ValueError` for a set that this processor or this build lacks.
    """
    sets = instruction_sets()
    chosen = instruction_set or os.environ.get(VARIABLE) or sets[-1]
    if chosen not in sets:
        raise ValueError(f"`{VARIABLE}` must be one of {', '.join(sets)}, got {chosen!r}")
    return _path(chosen)


def _known() -> int:
    """Return the place in `SETS` of the best set of this processor."""
    return ctypes.CDLL(os.fspath(_path("basic"))).microcosmos_instruction_set()


def _path(name: str) -> Path:
    return Path(__file__).with_name(f"{name}.so")
