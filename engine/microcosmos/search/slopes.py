"""Slopes of fitness and descriptors by genes, for blocks of genotypes."""

from collections.abc import Callable

import jax
import jax.numpy as jnp

from ..genomes import Genotype
from .emitters import Slopes
from .evaluation import Task, mapped
from .gradients import parts, value_and_jacobian


def slopes(
    task: Task, genotype: Genotype, descriptors: tuple[str, ...], segment: int | None = None
) -> Slopes:
    """Derivatives of fitness and of descriptors, by name, of one creature."""
    values = parts(task, genotype, ("genes",))
    of = ("fitness", *descriptors)
    found, rows = value_and_jacobian(task, genotype, values, of, segment=segment)
    sound = jnp.all(jnp.isfinite(found)) & jnp.all(jnp.isfinite(rows["genes"]))
    return Slopes(jnp.nan_to_num(rows["genes"]), sound)


def slopes_program(
    task: Task, descriptors: tuple[str, ...], segment: int | None, options: dict
) -> Callable[[Genotype], Slopes]:
    """One compiled program for a block of genotypes."""
    return jax.jit(
        lambda block: mapped(lambda one: slopes(task, one, descriptors, segment), block),
        compiler_options=options,
    )
