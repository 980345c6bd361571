"""Offspring: the creatures of the next generation, before they are evaluated.

A search with initial creatures evaluates those first, a batch at a time. Their children fill
the rest of the last such batch.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import zip_longest
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .. import neat, search
from ..genomes import Genotype, Graph
from ..search.emitters.population import Population
from . import breeding, screening
from .named import InitialCreatures
from .state import Plan, State

INITIAL, BRED = -1, -2
"""Numbers that stand for no emitter: an initial creature, and a child of a chosen one."""


@dataclass(frozen=True)
class Lessons:
    """The compiled parts of one emitter's lessons."""

    number: int
    """Lessons in a generation."""
    to_differentiate: Callable[..., Genotype]
    slopes: Callable[[Genotype], search.Slopes]
    """Slopes of a block of genotypes."""
    learn: Callable[..., tuple[search.Children, Any]]


@dataclass(frozen=True)
class LessonResults:
    """The results of a generation's lessons."""

    simulated: int = 0
    """Creatures simulated, forwards and backwards."""
    finite: int = 0
    """Creatures with finite slopes."""
    norms: tuple[float, ...] = ()
    """Lengths of the finite slopes of fitness."""

    def summary(self) -> dict[str, float]:
        """Return figures for the report; empty without lessons."""
        if not self.simulated:
            return {}
        found = {"slopes: finite": self.finite / self.simulated}
        return found | ({"slopes: length": float(np.median(self.norms))} if self.norms else {})

    def with_lesson(self, slopes: search.Slopes) -> "LessonResults":
        finite = np.asarray(slopes.finite)
        norms = np.linalg.norm(np.asarray(slopes.rows)[finite, 0], axis=-1)
        return LessonResults(
            self.simulated + len(finite),
            self.finite + int(finite.sum()),
            self.norms + tuple(norms.tolist()),
        )


@dataclass(frozen=True)
class Programs:
    """The compiled parts of a generation."""

    emit: Callable[..., tuple[search.Children, tuple, neat.Counters]]
    """Children from the emitters' states, an archive, counters, a generation and the emitter of
    each slot."""
    evaluate_block: Callable[[Genotype], search.Evaluation]
    insert: Callable[..., tuple[search.Elites, search.Inserted]]
    overwrite: Callable[..., tuple[search.Elites, search.Inserted]]
    """As `insert`; the genotypes of the old archive may be overwritten."""
    credit: Callable[..., Float[Array, "cell"]]
    tell: Callable[[tuple, search.Outcome], tuple]
    forget: Callable[..., search.reevaluation.Repeats]
    lessons: tuple[Lessons | None, ...]
    """Lessons of each emitter whose children learn before evaluation."""
    screen: screening.Programs | None = None
    breed: Callable[..., tuple[search.Children, neat.Counters]] | None = None
    """Children of chosen creatures, from an archive of them, counters, a generation and the
    emitter of each slot; None if the search cannot descend from chosen ones."""


@dataclass(frozen=True)
class Offspring:
    """Children before their evaluation."""

    children: search.Children
    emitters: tuple[Any, ...]
    counters: neat.Counters
    results: LessonResults
    began: float
    """Device seconds at the start of lessons and evaluation."""
    names: np.ndarray
    """Names of the creatures that parents were drawn from, by cell."""
    from_archive: bool
    """Whether parents are elites, not initial creatures."""
    emitter: np.ndarray
    """The number of each slot's emitter, `INITIAL` or `BRED`."""
    before: tuple[tuple[Any] | None, ...] = ()
    """The earlier state of each emitter some of whose children were replaced."""

    def summary(self, inserted: search.Inserted) -> dict[str, float]:
        """Return figures for the report: of lessons, and of children of chosen creatures."""
        return self.results.summary() | breeding.summary(self.emitter == BRED, inserted)

    def without_replaced(self, states: tuple[Any, ...]) -> tuple[Any, ...]:
        """Return the states; emitters whose children were replaced keep the earlier one."""
        pairs = zip_longest(states, self.before)
        return tuple(old[0] if old else new for new, old in pairs)


def next_offspring(
    plan: Plan,
    programs: Programs,
    devices: search.Devices,
    state: State,
    stop: Callable[[], bool],
) -> Offspring:
    """Return the next generation's children, those of chosen creatures among them."""
    return _with_bred(plan, programs, state, _unbred(plan, programs, devices, state, stop))


def _unbred(
    plan: Plan,
    programs: Programs,
    devices: search.Devices,
    state: State,
    stop: Callable[[], bool],
) -> Offspring:
    first, initial = state.generation * plan.batch, state.initial
    emitter = divided(plan, state)
    if initial is None or first >= len(initial.creature):
        if programs.screen and state.screened and state.screened.model.ready:
            return _screened(plan, programs, programs.screen, devices, state, emitter, stop)
        names = state.creatures
        return _emitted(plan, programs, devices, state, state.elites, names, emitter, stop)
    found, names = _initial_archive(plan, state, initial)
    offspring = _emitted(plan, programs, devices, state, found, names, emitter, stop)
    offspring = replace(offspring, from_archive=False)
    places = np.arange(first, min(first + plan.batch, len(initial.creature)))
    return _with_initial(plan, state, offspring, initial, places)


def divided(plan: Plan, state: State) -> np.ndarray:
    """Return the number of the emitter of each slot of the next generation."""
    slots = tuple(emitter.slots for emitter in plan.emitters)
    if plan.bandit is not None:
        children, inserted, improved = state.outcomes[-plan.bandit.window :].sum(0).T
        if children.any():  # Before the first generation nothing is known.
            known = children.tolist(), (inserted + improved).tolist()
            slots = plan.bandit.slots(*known, plan.batch)
    return np.repeat(np.arange(len(slots), dtype=np.int32), slots)


def _emitted(
    plan: Plan,
    programs: Programs,
    devices: search.Devices,
    state: State,
    elites: search.Elites,
    names: np.ndarray,
    emitter: np.ndarray,
    stop: Callable[[], bool],
) -> Offspring:
    children, emitters, counters = programs.emit(
        state.emitters, elites, state.counters, jnp.asarray(state.generation), emitter
    )
    children, began = jax.device_get(children), devices.seconds()
    slots = tuple(emitter.slots for emitter in plan.emitters)
    children, emitters, results = _teach(
        programs.lessons, devices, slots, children, emitters, block=plan.block, stop=stop
    )
    return Offspring(children, emitters, counters, results, began, names, True, emitter)


def _screened(
    plan: Plan,
    programs: Programs,
    given: screening.Programs,
    devices: search.Devices,
    state: State,
    emitter: np.ndarray,
    stop: Callable[[], bool],
) -> Offspring:
    began = devices.seconds()
    inserts = programs.insert, programs.overwrite
    pool, counters = screening.candidates(plan, given, inserts, state, emitter, stop)
    children, counters = screening.chosen(plan, given, state, pool, counters, emitter)
    results, names = LessonResults(), state.creatures
    return Offspring(children, state.emitters, counters, results, began, names, True, emitter)


def _initial_archive(
    plan: Plan, state: State, initial: InitialCreatures
) -> tuple[search.Elites, np.ndarray]:
    count = min(plan.cell_count, len(initial.creature))
    empty = search.no_elites(plan.cell_count, len(search.MEASURES), plan.genotype)
    genotypes = jax.tree.map(
        lambda none, x: none.at[:count].set(x[:count]), empty.genotypes, initial.genotypes
    )
    occupied = empty.occupied.at[:count].set(True)
    lacking = np.zeros((max(0, plan.cell_count - count), 32), np.uint8)
    names = np.concatenate([initial.creature, lacking])
    equal = occupied.astype(jnp.float32)
    found = replace(empty, occupied=occupied, curiosity=equal, genotypes=genotypes)
    return found, names


def _with_initial(
    plan: Plan,
    state: State,
    offspring: Offspring,
    initial: InitialCreatures,
    places: np.ndarray,
) -> Offspring:
    count = len(places)

    def put(old: Any, new: Any) -> np.ndarray:
        return np.concatenate([np.asarray(new), np.asarray(old)[count:]])

    parents = np.stack([places, np.full(count, search.NO_PARENT)], 1)
    new = search.Children(
        genotypes=jax.tree.map(lambda x: x[places], initial.genotypes),
        parents=jnp.asarray(parents, jnp.int32),
        operator=jnp.full(count, search.OPERATORS.index("fork"), jnp.int32),
    )
    children = jax.tree.map(put, offspring.children, new)
    begins = np.cumsum([0, *(emitter.slots for emitter in plan.emitters[:-1])]).tolist()
    pairs = zip(state.emitters, begins, strict=True)
    # A population's networks are those that were evaluated in its slots.
    before = tuple(
        (kept,) if first < count and not isinstance(kept, Population) else None
        for kept, first in pairs
    )
    emitter = put(offspring.emitter, np.full(count, INITIAL, np.int32))
    return replace(offspring, children=children, before=before, emitter=emitter)


def _with_bred(plan: Plan, programs: Programs, state: State, offspring: Offspring) -> Offspring:
    """Return the offspring after children of chosen creatures have taken some slots."""
    before = offspring.counters
    new = breeding.bred(plan, programs.breed, state, before, offspring.emitter)
    if new is None:
        return offspring

    def put(old: Any, rows: Any) -> np.ndarray:
        whole = np.array(old)
        whole[new.slots] = rows
        return whole

    children = jax.tree.map(put, offspring.children, new.children)
    counters = new.counters
    if isinstance(children.genotypes, Graph):  # Replaced children leave numbers unused.
        genotypes, counters = neat.compacted(children.genotypes, state.counters)
        children = eqx.tree_at(lambda one: one.genotypes, children, genotypes)
    return replace(
        offspring,
        children=children,
        counters=counters,
        names=np.concatenate([offspring.names, new.names]),
        emitter=put(offspring.emitter, BRED),
    )


def _teach(
    lessons: tuple[Lessons | None, ...],
    devices: search.Devices,
    slots: tuple[int, ...],
    children: search.Children,
    states: tuple[Any, ...],
    *,
    block: int,
    stop: Callable[[], bool],
) -> tuple[search.Children, tuple[Any, ...], LessonResults]:
    parts, kept, results, first = [], [], LessonResults(), 0
    for lesson, count, state in zip(lessons, slots, states, strict=True):
        offspring = jax.tree.map(lambda x, a=first, b=first + count: x[a:b], children)
        for _ in range(lesson.number if lesson else 0):
            assert lesson is not None
            asked = jax.device_get(lesson.to_differentiate(state, offspring))
            number = len(jax.tree.leaves(asked)[0])
            found = devices.evaluate(lesson.slopes, asked, block=min(block, number), stop=stop)
            offspring, state = lesson.learn(state, offspring, found)
            results = results.with_lesson(found)
        parts.append(jax.device_get(offspring))
        kept.append(state)
        first += count
    if not results.simulated:
        return children, states, results
    whole = jax.tree.map(lambda *rows: np.concatenate(rows), *parts)
    return whole, tuple(kept), results
