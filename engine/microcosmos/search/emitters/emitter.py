"""What an emitter is: a source of children that learns what became of them."""

from typing import Protocol, runtime_checkable

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, Key, PRNGKeyArray, PyTree

from ...genomes import Genotype
from ...neat import Counters
from ..insertion import Elites

OPERATORS = (
    "random",
    "neat",
    "crossover",
    "copy",
    "iso+line",
    "gaussian",
    "cma-me",
    "cma-mae",
    "tensorneat",
    "lamarckian",
    "cma-mega",
    "fork",
)
"""How a child arose, by operator code."""

NO_PARENT = -1

Keys = Key[Array, "slot"]
"""A key for each slot."""

Kept = PyTree[Array | np.ndarray]
"""An emitter's state."""


class Children(eqx.Module):
    """Genotypes to be evaluated.

    A parent is a cell of the archive, or a slot of the generation before plus the number of
    cells, or −1.
    """

    genotypes: Genotype
    parents: Int[Array, "slot 2"]
    operator: Int[Array, "slot"]


class Outcome(eqx.Module):
    """What became of children."""

    genotypes: Genotype
    fitness: Float[Array, "slot"]
    measures: Float[Array, "slot measure"]
    sound: Bool[Array, "slot"]
    """Whether the evaluation counts."""
    cell: Int[Array, "slot"]
    entered: Bool[Array, "slot"]
    fresh: Bool[Array, "slot"]
    """Whether the cell was empty before."""
    improvement: Float[Array, "slot"]
    """Fitness above the elite that the cell had before; above 0 where it had none."""


@runtime_checkable
class Divided(Protocol):
    """What an emitter keeps, where that is a population divided into species."""

    def sizes(self) -> dict[int, int]:
        """Members of each species of the last children, by its number."""
        ...


@runtime_checkable
class Emitter(Protocol):
    """A source of children in a fixed number of slots; its state is arrays."""

    @property
    def slots(self) -> int:
        """Children a generation."""
        ...

    def init(self, *, key: PRNGKeyArray) -> Kept:
        """Before the first generation."""
        ...

    def emit(
        self,
        state: Kept,
        archive: Elites,
        counters: Counters,
        generation: Int[Array, ""],
        *,
        keys: Keys,
    ) -> tuple[Children, Kept, Counters]:
        """Children, with a key for each slot; new genes are numbered by `counters`."""
        ...

    def tell(self, state: Kept, outcome: Outcome) -> Kept:
        """The state once its children are measured and inserted."""
        ...


def emit(
    emitters: tuple[Emitter, ...],
    states: tuple[Kept, ...],
    archive: Elites,
    counters: Counters,
    generation: Int[Array, ""],
    *,
    key: PRNGKeyArray,
) -> tuple[Children, tuple[Kept, ...], Counters]:
    """The children of all emitters, one after another, and what the emitters keep of them.

    Every slot has a key of its own, derived from the seed, the generation and the slot.
    """
    batch = sum(emitter.slots for emitter in emitters)
    turn = jax.random.fold_in(key, generation)
    keys = jax.vmap(lambda slot: jax.random.fold_in(turn, slot))(jnp.arange(batch))
    taught_offspring, kept, first = [], [], 0
    for emitter, state in zip(emitters, states, strict=True):
        own = keys[first : first + emitter.slots]
        offspring, state, counters = emitter.emit(
            state, archive, counters, generation, keys=own
        )
        taught_offspring.append(offspring)
        kept.append(state)
        first += emitter.slots
    children = jax.tree.map(lambda *parts: jnp.concatenate(parts), *taught_offspring)
    return children, tuple(kept), counters


def tell(
    emitters: tuple[Emitter, ...], states: tuple[Kept, ...], outcome: Outcome
) -> tuple[Kept, ...]:
    """Each emitter's state once it has seen what became of its own children."""
    told, first = [], 0
    for emitter, state in zip(emitters, states, strict=True):
        rows = slice(first, first + emitter.slots)
        told.append(emitter.tell(state, jax.tree.map(lambda x, rows=rows: x[rows], outcome)))
        first += emitter.slots
    return tuple(told)
