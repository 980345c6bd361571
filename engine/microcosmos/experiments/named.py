"""Creatures that a search is given by name: initial ones, and those chosen meanwhile."""

from dataclasses import dataclass

import equinox as eqx
import jax
import numpy as np
from jaxtyping import Int, UInt8

from ..genomes import Genotype


class InitialCreatures(eqx.Module):
    """Initial creatures, in the order of their names."""

    creature: UInt8[np.ndarray, "row 32"]
    genotypes: Genotype
    """Rows of NumPy arrays."""


@dataclass(frozen=True)
class Breeding:
    """Descent from chosen creatures; see `spec.Breeding`."""

    share: float
    half_life: float


class Choices(eqx.Module):
    """Creatures that people chose, by the generation from which each counts and by name."""

    generation: Int[np.ndarray, "row"]
    creature: UInt8[np.ndarray, "row 32"]
    genotypes: Genotype
    """Rows of NumPy arrays."""


def no_choices(genotype: Genotype) -> Choices:
    rows = jax.tree.map(lambda x: np.zeros((0, *x.shape), x.dtype), genotype)
    return Choices(np.zeros(0, np.int32), np.zeros((0, 32), np.uint8), rows)


def rows_of(names: list[str], genotypes: list[Genotype]) -> tuple[np.ndarray, Genotype]:
    """Return names as rows of bytes, and their genotypes as rows."""
    creature = np.stack([np.frombuffer(bytes.fromhex(name), np.uint8) for name in names])
    return creature, jax.tree.map(lambda *parts: np.stack(parts), *genotypes)
