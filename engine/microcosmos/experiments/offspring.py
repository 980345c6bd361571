"""Offspring: the creatures of the next generation, before they are evaluated.

A search with initial creatures evaluates those first, a batch at a time. Their children fill
the rest of the last such batch.
"""

import json
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from .. import neat, search
from ..genomes import Genotype
from ..search.emitters.population import Population
from .learning import Lessons, Taught, teach
from .state import InitialCreatures, Plan, State


@dataclass(frozen=True)
class Programs:
    """The compiled parts of a generation."""

    emit: Callable[..., tuple[search.Children, tuple, neat.Counters]]
    evaluate_block: Callable[[Genotype], search.Evaluation]
    insert: Callable[..., tuple[search.Elites, search.Inserted]]
    tell: Callable[[tuple, search.Outcome], tuple]
    forget: Callable[..., search.reevaluation.Repeats]
    lessons: tuple[Lessons | None, ...]
    """Of each emitter, where its children learn before they live."""


@dataclass(frozen=True)
class Offspring:
    """Children that are not evaluated yet."""

    children: search.Children
    emitters: tuple[Any, ...]
    counters: neat.Counters
    taught: Taught
    began: float
    """When lessons and evaluation began."""
    names: np.ndarray
    """Of the creatures that parents were drawn from, by cell."""
    untold: tuple[Any, ...] | None = None
    """Of each emitter some of whose children were replaced, the state before; else None."""

    def kept(self, told: tuple[Any, ...]) -> tuple[Any, ...]:
        """What emitters keep: one that lost children to others must not learn from those."""
        if self.untold is None:
            return told
        pairs = zip(told, self.untold, strict=True)
        return tuple(new if before is None else before[0] for new, before in pairs)


def refuse_lacking(plan: Plan) -> None:
    """Raise `ValueError` where the spec names creatures that are not there."""
    named = json.loads(plan.spec)["search"].get("initial", [])
    if named and plan.initial is None:
        raise ValueError(
            f"`search.initial` names {len(named)} creatures, whose files are needed to begin"
        )


def next_offspring(
    plan: Plan, programs: Programs, state: State, stop: Callable[[], bool]
) -> Offspring:
    """The next generation's children."""
    first, initial = state.generation * plan.batch, state.initial
    if initial is None or first >= len(initial.creature):
        return _emitted(plan, programs, state, state.elites, state.creatures, stop)
    found, names = _gathered(plan, state, initial)
    offspring = _emitted(plan, programs, state, found, names, stop)
    places = np.arange(first, min(first + plan.batch, len(initial.creature)))
    return _replaced(plan, state, offspring, initial, places)


def _emitted(
    plan: Plan,
    programs: Programs,
    state: State,
    elites: search.Elites,
    names: np.ndarray,
    stop: Callable[[], bool],
) -> Offspring:
    """What emitters make of an archive."""
    children, emitters, counters = programs.emit(
        state.emitters, elites, state.counters, jnp.asarray(state.generation)
    )
    children, began = jax.device_get(children), time.monotonic()
    slots = tuple(emitter.slots for emitter in plan.emitters)
    children, emitters, taught = teach(
        programs.lessons, slots, children, emitters, block=plan.block, stop=stop
    )
    return Offspring(children, emitters, counters, taught, began, names)


def _gathered(
    plan: Plan, state: State, initial: InitialCreatures
) -> tuple[search.Elites, np.ndarray]:
    """An archive that holds what the search begins from, and the names by cell."""
    count = min(plan.cell_count, len(initial.creature))
    nobody = search.no_elites(plan.cell_count, len(search.MEASURES), plan.genotype)
    genotypes = jax.tree.map(
        lambda none, x: none.at[:count].set(x[:count]), nobody.genotypes, initial.genotypes
    )
    occupied = nobody.occupied.at[:count].set(True)
    lacking = np.zeros((max(0, plan.cell_count - count), 32), np.uint8)
    names = np.concatenate([initial.creature, lacking])
    return replace(nobody, occupied=occupied, genotypes=genotypes), names


def _replaced(
    plan: Plan,
    state: State,
    offspring: Offspring,
    initial: InitialCreatures,
    places: np.ndarray,
) -> Offspring:
    """The offspring with creatures of before in its first slots."""
    children, count = offspring.children, len(places)

    def put(values: Any, new: Any) -> np.ndarray:
        return np.concatenate([np.asarray(new), np.asarray(values)[count:]])

    own = jax.tree.map(lambda x: x[places], initial.genotypes)
    parents = np.stack([places, np.full(count, search.NO_PARENT)], 1).astype(np.int32)
    code = np.full(count, search.OPERATORS.index("fork"), np.int32)
    old, form = jax.tree.flatten(children)
    new = jax.tree.leaves((own, parents, code))  # In the order of the fields of `Children`.
    whole = jax.tree.unflatten(form, [put(*pair) for pair in zip(old, new, strict=True)])
    ends = np.cumsum([emitter.slots for emitter in plan.emitters])
    begins = [0, *ends[:-1].tolist()]
    pairs = zip(state.emitters, begins, strict=True)
    # A population's networks are these very creatures.
    untold = tuple(
        (kept,) if first < count and not isinstance(kept, Population) else None
        for kept, first in pairs
    )
    return replace(offspring, children=whole, untold=untold)
