"""Breeding by eye: a share of each batch descends from creatures that people chose.

A choice counts from one generation on. The share is largest then and halves every `half_life`
generations; among several choices an older one counts less in the same proportion.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Int, UInt8

from ... import genomes, neat
from ...genomes import Genotype, Graph
from ..emitters import NO_PARENT, Children, Selecting
from ..loop import Leaf, Part, Plan, State, Turn
from .initial import Initial, parents_of
from .records import OUTCOMES, RunFacts, counted, no_genotypes

BRED = -2
"""Number of the emitter of a child of a chosen creature."""

MAX_PARENTS = 64
"""Most chosen creatures that have offspring in one generation, the last chosen."""

Emission = Callable[..., tuple[Children, neat.Counters]]
"""Children of chosen creatures, from an archive of them, counters, a generation and the emitter
of each slot."""


@dataclass(frozen=True)
class Settings:
    """Descent from chosen creatures; see `spec.Breeding`."""

    share: float
    half_life: float

    def remaining(self, age: int) -> Decimal:
        """Return the share of a choice's weight that is left.

        `Decimal` gives the same digits on every processor; `math.exp` does not promise it.
        """
        return Decimal(2) ** (-Decimal(age) / Decimal(self.half_life))


class Choices(eqx.Module):
    """Creatures that people chose, by the generation from which each counts and by name."""

    generation: Int[np.ndarray, "row"]
    creature: UInt8[np.ndarray, "row 32"]
    genotypes: Genotype
    """Rows of NumPy arrays."""


class UnknownCreature(ValueError):
    """A creature was chosen that never entered the archive before."""

    def __init__(self, generation: int, names: Sequence[str], device: str):
        super().__init__(
            f"`choices` of generation {generation} must be creatures that have entered the "
            f"archive of this run before, got {names[0]}. Choices repeat a run only where its "
            f"bytes are the same: the same spec, version and kind of device (here {device})"
        )
        self.names = tuple(names)


def part(settings: Settings, facts: RunFacts, emit: Emission) -> Part:
    """Return the part that lets offspring descend from chosen creatures."""
    return Part(
        name="breeding",
        begin=lambda plan: Choices(
            np.zeros(0, np.int32), np.zeros((0, 32), np.uint8), no_genotypes(plan)
        ),
        leaves={
            name: Leaf("row", f"choices/{name}", optional=True)
            for name in ("generation", "creature", "genotypes")
        },
        amend=lambda own, turn: (own, _with_bred(settings, emit, own, turn)),
        figures=_figures,
        receive=lambda own, state, files: _with_chosen(facts, own, state, files),
    )


def _with_chosen(
    facts: RunFacts, own: Choices, state: State, files: Sequence[Mapping[str, Any]]
) -> Choices:
    """Return the choices with creatures, given by their files, that count from now on.

    Raise `UnknownCreature` for one that never entered the archive.
    """
    if not files:
        return own
    given = {file["sha256"]: file["identity"]["genome"] for file in files}
    generation, names = state.generation + 1, sorted(given)
    known = {bytes(name).hex() for name in state.parts["lineage"].entries.creature}
    if unknown := [name for name in names if name not in known]:
        raise UnknownCreature(generation, unknown, facts.device)
    new = rows_of(names, [genomes.read(given[name], facts.encoding) for name in names])
    counted = np.full(len(names), generation, np.int32)
    chosen = Choices(counted, new.creature, new.genotypes)
    return jax.tree.map(lambda *parts: np.concatenate(parts), own, chosen)


def rows_of(names: Sequence[str], genotypes: Sequence[Genotype]) -> Initial:
    """Return names as rows of bytes, and their genotypes as rows."""
    creature = np.stack([np.frombuffer(bytes.fromhex(name), np.uint8) for name in names])
    return Initial(creature, jax.tree.map(lambda *parts: np.stack(parts), *genotypes))


def chosen(state: State) -> list[tuple[int, str]]:
    """Return the generation and the name of each choice."""
    own: Choices = state.parts["breeding"]
    names = [bytes(name).hex() for name in own.creature]
    return list(zip(own.generation.tolist(), names, strict=True))


def _with_bred(settings: Settings, emit: Emission, own: Choices, turn: Turn) -> Turn:
    """Return the turn after children of chosen creatures have taken some slots."""
    plan, batch = turn.plan, turn.batch
    if not len(own.generation):
        return turn
    free = np.flatnonzero(batch.emitter >= 0)
    last = int(own.generation.max())
    share = Decimal(settings.share) * settings.remaining(turn.number - last)
    count = min(len(free), round(share * plan.batch))
    if not count:
        return turn
    # Evenly over the batch, so that every emitter gives up its part (docs/evolution.md).
    slots = free[np.arange(count) * len(free) // count]
    # The last chosen come first; those of a generation are in the order of their names.
    rows = np.argsort(-own.generation, kind="stable")[:MAX_PARENTS]
    ages = last - own.generation[rows]
    weights = np.array([float(settings.remaining(age)) for age in ages.tolist()], np.float32)
    genotypes = jax.tree.map(lambda x: x[rows], own.genotypes)
    parents = parents_of(plan, MAX_PARENTS, genotypes, weights)
    breeder = jnp.asarray(_varying(plan, batch.emitter))
    generation = jnp.asarray(turn.before.generation)
    children, counters = emit(parents, batch.counters, generation, breeder)
    children = jax.tree.map(lambda x: np.asarray(x)[slots], jax.device_get(children))
    names = turn.parts["lineage"].names if batch.names is None else batch.names
    # The chosen have the numbers behind those of all other parents.
    places = np.where(children.parents < 0, NO_PARENT, children.parents + len(names))
    children = eqx.tree_at(lambda one: one.parents, children, places.astype(np.int32))
    return replace(
        turn,
        batch=replace(
            batch,
            **_merged(turn, slots, children, counters),
            names=np.concatenate([names, own.creature[rows]]),
            emitter=_put(slots, batch.emitter, BRED),
        ),
    )


def _put(slots: np.ndarray, old: Any, rows: Any) -> np.ndarray:
    whole = np.array(old)
    whole[slots] = rows
    return whole


def _merged(
    turn: Turn, slots: np.ndarray, new: Children, counters: neat.Counters
) -> dict[str, Any]:
    """Return the children with the new ones in some slots, and the counters after them."""
    children = jax.tree.map(lambda a, b: _put(slots, a, b), turn.batch.children, new)
    if isinstance(children.genotypes, Graph):  # Replaced children leave numbers unused.
        genotypes, counters = neat.compacted(children.genotypes, turn.before.counters)
        children = eqx.tree_at(lambda one: one.genotypes, children, genotypes)
    return {"children": children, "counters": counters}


def _varying(plan: Plan, emitter: Int[np.ndarray, "slot"]) -> Int[np.ndarray, "slot"]:
    """Return each slot's emitter, or in turn one that varies parents where it does not."""
    numbered = enumerate(plan.emitters)
    varying = [number for number, one in numbered if isinstance(one, Selecting)]
    in_turn = np.resize(np.array(varying, np.int32), len(emitter))
    return np.where(np.isin(emitter, varying), emitter, in_turn)


def _figures(own: Choices, turn: Turn) -> dict[str, int | float]:
    """Return counts of the children of chosen creatures; empty without any."""
    bred = turn.batch.emitter == BRED
    if not bred.any():
        return {}
    (counts,) = counted(np.where(bred, 0, BRED), turn.settled.inserted, 1).tolist()
    return {f"emitter.chosen.{name}": n for name, n in zip(OUTCOMES, counts, strict=True)}
