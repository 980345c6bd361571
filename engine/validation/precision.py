"""Numbers of 32 or 64 bits, as a check asks for."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Literal

import jax
import jax.numpy as jnp

Precision = Literal["float32", "float64"]


@contextmanager
def precision(name: Precision) -> Iterator[Any]:
    """JAX computes with numbers of this kind; the kind itself."""
    with jax.enable_x64(name == "float64"):
        yield jnp.dtype(name)
