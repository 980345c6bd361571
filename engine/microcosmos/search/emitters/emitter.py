"""Emitters: sources of children, which learn the outcome of their evaluation."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, TypeVar, runtime_checkable

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, Key, PRNGKeyArray, PyTree

from ...genomes import Genotype, Graph
from ...neat import Counters, Novelty, Rates, no_novelty, number
from ...operators import OPERATORS
from ..cells import Cells
from ..gradients import Slopes
from ..insertion import Elites, Inserted

NO_PARENT = -1

BEFORE = 2**32 - 1
"""Number of the generation before the first, for deriving keys."""

Keys = Key[Array, "slot"]

State = PyTree[Array | np.ndarray]
"""The state of an emitter."""

Newcomer = Callable[..., Any]
"""`newcomer(key=...)` makes a random genotype."""

T = TypeVar("T")


class Children(eqx.Module):
    """Genotypes to be evaluated.

    A parent is a cell of the archive, or a slot of the generation before plus the number of
    cells, or −1. Parts number others behind those.
    """

    genotypes: Genotype
    parents: Int[Array, "slot 2"]
    operator: Int[Array, "slot"]


class Outcome(eqx.Module):
    """Evaluated children, and their insertion; see `Inserted` for its last four fields."""

    genotypes: Genotype
    fitness: Float[Array, "slot"]
    measures: Float[Array, "slot measure"]
    feasible: Bool[Array, "slot"]
    """True if the evaluation is feasible."""
    cell: Int[Array, "slot"]
    entered: Bool[Array, "slot"]
    fresh: Bool[Array, "slot"]
    improvement: Float[Array, "slot"]


def outcome(candidates: Elites, inserted: Inserted) -> Outcome:
    """Return the outcome of candidates for the archive."""
    return Outcome(
        genotypes=candidates.genotypes,
        fitness=candidates.fitness,
        measures=candidates.measures,
        feasible=candidates.occupied,
        **vars(inserted),
    )


@dataclass(frozen=True)
class Problem:
    """The facts about a search from which its emitters are built."""

    slots: int
    """Children a generation."""
    operator: int
    """Number of the operator that makes the children."""
    newcomer: Newcomer
    cells: Cells
    """Cells of the descriptors."""
    seed: int
    rates: Rates
    """Rates of NEAT's mutations."""
    inputs: int
    """Inputs of networks; 0 for genomes of numbers."""
    outputs: int
    room: tuple[int, int] | None
    """Most nodes and connections of networks; None for genomes of numbers."""


@runtime_checkable
class Emitter(Protocol):
    """A source of children in a fixed number of slots; its state is arrays."""

    @property
    def slots(self) -> int:
        """Children a generation."""
        ...

    def init(self, *, key: PRNGKeyArray) -> State:
        """Return the state before the first generation."""
        ...

    def emit(
        self, state: State, archive: Elites, *, keys: Keys
    ) -> tuple[Children, State, Novelty | None]:
        """Return children, one for each key, the state, and new genes that have no numbers.

        None stands for children without new genes.
        """
        ...

    def tell(self, state: State, outcome: Outcome) -> State:
        """Return the state once its children are numbered, measured and inserted."""
        ...


class Stateless:
    """The part of an emitter that has no state and learns nothing."""

    def init(self, *, key: PRNGKeyArray) -> None:
        return None

    def tell(self, state: None, outcome: Outcome) -> None:
        return None


@runtime_checkable
class Learner(Emitter, Protocol):
    """An emitter that improves its children by derivatives, `lessons` times a generation."""

    @property
    def lessons(self) -> int:
        """Number of updates by derivatives in a generation."""
        ...

    def to_differentiate(self, state: State, children: Children) -> Genotype:
        """Return the genotypes whose derivatives the next lesson needs, as a batch."""
        ...

    def learn(self, state: State, children: Children, slopes: Slopes) -> tuple[Children, State]:
        """Return the children and the state after a lesson."""
        ...


def begin(emitters: tuple[Emitter, ...], *, key: PRNGKeyArray) -> tuple[State, ...]:
    """Return the emitters' states before the first generation."""
    count = len(emitters)
    # One program: outside of one, each operation on keys compiles its own.
    split = jax.jit(lambda key: tuple(jax.random.split(jax.random.fold_in(key, BEFORE), count)))
    pairs = zip(emitters, split(key), strict=True)
    return tuple(emitter.init(key=own) for emitter, own in pairs)


def emit(
    emitters: tuple[Emitter, ...],
    states: tuple[State, ...],
    archive: Elites,
    counters: Counters,
    generation: Int[Array, ""],
    *,
    key: PRNGKeyArray,
) -> tuple[Children, tuple[State, ...], Counters]:
    """Return the children of all emitters, one after another, and the emitters' new states.

    Every slot has its own key, derived from the seed, the generation and the slot. Equal
    mutations get equal numbers, also in children of different emitters.
    """
    keys = _keys(key, generation, sum(emitter.slots for emitter in emitters))
    children_of, kept, genes, first = [], [], [], 0
    for emitter, state in zip(emitters, states, strict=True):
        chosen = keys[first : first + emitter.slots]
        offspring, state, novelty = emitter.emit(state, archive, keys=chosen)
        children_of.append(offspring)
        kept.append(state)
        genes.append(novelty)
        first += emitter.slots
    children = jax.tree.map(lambda *parts: jnp.concatenate(parts), *children_of)
    parts = _filled(genes, [emitter.slots for emitter in emitters])
    novelty = jax.tree.map(lambda *rows: jnp.concatenate(rows), *parts)
    # All at once: the same mutation has one number whichever emitter made it
    # (tests/engine/search/test_numbering.py).
    children, counters = _numbered(children, novelty, counters)
    return children, tuple(kept), counters


def emit_chosen(
    emitters: tuple[Emitter, ...],
    archive: Elites,
    counters: Counters,
    generation: Int[Array, ""],
    chosen: Int[Array, "slot"],
    *,
    key: PRNGKeyArray,
) -> tuple[Children, Counters]:
    """Return children, one of the chosen emitter for each slot.

    The emitters must have no state. All emit for all slots, so one program serves every
    choice; a child is the same as that of `emit` if its emitter has the slot.
    """
    slots = chosen.shape[0]
    keys = _keys(key, generation, slots)
    emitted = [with_slots(one, slots).emit(None, archive, keys=keys) for one in emitters]

    def of_chosen(*rows):
        return jnp.stack(rows)[chosen, jnp.arange(slots)]

    children = jax.tree.map(of_chosen, *(offspring for offspring, _, _ in emitted))
    parts = _filled([novelty for _, _, novelty in emitted], [slots] * len(emitted))
    return _numbered(children, jax.tree.map(of_chosen, *parts), counters)


def with_slots(emitter: Emitter, slots: int) -> Any:
    """Return an emitter without a state with another number of slots."""
    dataclass: Any = emitter
    return replace(dataclass, slots=slots)


def _keys(key: PRNGKeyArray, generation: Int[Array, ""], slots: int) -> Keys:
    turn = jax.random.fold_in(key, generation)
    return jax.vmap(lambda slot: jax.random.fold_in(turn, slot))(jnp.arange(slots))


def _filled(parts: list[Novelty | None], slots: list[int]) -> list[Novelty] | list[None]:
    """Return the new genes of every emitter's children; None for all if there are none."""
    like = next((part for part in parts if part is not None), None)
    if like is None:
        return [None] * len(parts)
    pairs = zip(parts, slots, strict=True)
    return [no_novelty(like, count) if part is None else part for part, count in pairs]


def _numbered(
    children: Children, novelty: Novelty | None, counters: Counters
) -> tuple[Children, Counters]:
    if novelty is None:
        return children, counters
    assert isinstance(children.genotypes, Graph)
    genotypes, counters = number(children.genotypes, novelty, counters)
    return replace(children, genotypes=genotypes), counters


def tell(
    emitters: tuple[Emitter, ...], states: tuple[State, ...], outcome: Outcome
) -> tuple[State, ...]:
    """Return the state of each emitter after the outcome of its own children."""
    after, first = [], 0
    for emitter, state in zip(emitters, states, strict=True):
        rows = slice(first, first + emitter.slots)
        after.append(emitter.tell(state, jax.tree.map(lambda x, rows=rows: x[rows], outcome)))
        first += emitter.slots
    return tuple(after)


def newcomers(newcomer: Newcomer, keys: Keys) -> Children:
    """Draw random genotypes, one for each key."""
    genotypes = jax.vmap(lambda key: newcomer(key=key))(keys)
    return parentless(genotypes, keys.shape[0], "random")


def parentless(genotypes: Genotype, slots: int, operator: str | int) -> Children:
    """Return children of an operator, given by name or number, without known parents."""
    parents = jnp.full((slots, 2), NO_PARENT, jnp.int32)
    return Children(genotypes, parents, jnp.full(slots, _number_of(operator), jnp.int32))


def children(
    genotypes: Genotype, parents: Sequence[Int[Array, "slot"]], operator: str | int
) -> Children:
    """Return children of an operator, given by name or number, and one or two parents, given
    as cells."""
    first, second = (*parents, jnp.full_like(parents[0], NO_PARENT))[:2]
    pairs = jnp.stack([first, second], 1).astype(jnp.int32)
    return Children(genotypes, pairs, jnp.full(len(first), _number_of(operator), jnp.int32))


def _number_of(operator: str | int) -> int:
    return OPERATORS.index(operator) if isinstance(operator, str) else operator


def or_newcomers(archive: Elites, varied: T, fresh: T) -> T:
    """Return the varied children, or the fresh ones if the archive is empty."""
    any_elite = jnp.any(archive.occupied)
    return jax.tree.map(lambda one, other: jnp.where(any_elite, one, other), varied, fresh)
