"""Breeding by eye: a part of each batch descends from creatures that people chose.

A choice counts from one generation on. The part is largest then and halves every `half_life`
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
from jaxtyping import Bool, Int

from .. import genomes, neat, search
from .named import Choices, rows_of
from .state import Plan, State

MAX_PARENTS = 64
"""Most chosen creatures that have offspring in one generation, the last chosen."""


class UnknownCreature(ValueError):
    """A creature was chosen that never entered the archive before."""

    def __init__(self, generation: int, names: Sequence[str], device: str):
        super().__init__(
            f"`choices` of generation {generation} must be creatures that have entered the "
            f"archive of this run before, got {names[0]}. Choices repeat a run only where its "
            f"bytes are the same: the same spec, version and kind of device (here {device})"
        )
        self.names = tuple(names)


@dataclass(frozen=True)
class Bred:
    """Children of chosen creatures, in some slots of a batch."""

    slots: Int[np.ndarray, "child"]
    children: search.Children
    """NumPy arrays; parents are rows of `names` after the cells of the archive."""
    counters: neat.Counters
    names: np.ndarray
    """Names of the chosen creatures."""


def choose(plan: Plan, state: State, files: Sequence[Mapping[str, Any]]) -> State:
    """Return the state in which creatures, given by their files, count from now on.

    Raise `UnknownCreature` for one that never entered the archive.
    """
    assert plan.breeding is not None, "`spec.breeding_refusal` says why"
    if not files:
        return state
    given = {file["sha256"]: file["identity"]["genome"] for file in files}
    generation, names = state.generation + 1, sorted(given)
    known = {bytes(name).hex() for name in state.lineage.creature}
    if unknown := [name for name in names if name not in known]:
        raise UnknownCreature(generation, unknown, plan.device)
    rows = rows_of(names, [genomes.read(given[name], plan.encoding) for name in names])
    new = Choices(np.full(len(names), generation, np.int32), *rows)
    choices = jax.tree.map(lambda *parts: np.concatenate(parts), state.choices, new)
    return replace(state, choices=choices)


def bred(
    plan: Plan,
    emit: Callable[..., tuple[search.Children, neat.Counters]] | None,
    state: State,
    counters: neat.Counters,
    emitter: Int[np.ndarray, "slot"],
) -> Bred | None:
    """Return the next children of chosen creatures; None without any.

    `emitter` is the number of each slot's emitter, negative for a slot that is taken.
    """
    if emit is None or plan.breeding is None or not len(state.choices.generation):
        return None
    free = np.flatnonzero(emitter >= 0)
    last, number = int(state.choices.generation.max()), state.generation + 1
    part = Decimal(plan.breeding.share) * _remaining(plan, number - last)
    count = min(len(free), round(part * plan.batch))
    if not count:
        return None
    slots = free[np.arange(count) * len(free) // count]
    # The last chosen come first; those of a generation are in the order of their names.
    rows = np.argsort(-state.choices.generation, kind="stable")[:MAX_PARENTS]
    ages = last - state.choices.generation[rows]
    weights = np.array([float(_remaining(plan, age)) for age in ages.tolist()], np.float32)
    parents, generation = _parents(plan, state.choices, rows, weights), state.generation
    breeder = jnp.asarray(_varying(plan, emitter))
    children, counters = emit(parents, counters, jnp.asarray(generation), breeder)
    children = jax.tree.map(lambda x: np.asarray(x)[slots], jax.device_get(children))
    own = np.where(children.parents < 0, search.NO_PARENT, children.parents + plan.cell_count)
    children = eqx.tree_at(lambda one: one.parents, children, own.astype(np.int32))
    return Bred(slots, children, counters, state.choices.creature[rows])


def rows(choices: Choices) -> list[tuple[int, str]]:
    """Return the generation and the name of each choice."""
    names = [bytes(name).hex() for name in choices.creature]
    return list(zip(choices.generation.tolist(), names, strict=True))


def summary(bred: Bool[np.ndarray, "slot"], inserted: search.Inserted) -> dict[str, int]:
    """Return counts of the children of chosen creatures; empty without any."""
    if not bred.any():
        return {}
    entered, fresh = np.asarray(inserted.entered)[bred], np.asarray(inserted.fresh)[bred]
    return {
        "chosen: children": int(bred.sum()),
        "chosen: inserted": int(np.sum(entered & fresh)),
        "chosen: improved": int(np.sum(entered & ~fresh)),
    }


def _varying(plan: Plan, emitter: Int[np.ndarray, "slot"]) -> Int[np.ndarray, "slot"]:
    """Return each slot's emitter, or in turn one that varies parents where it does not."""
    varying = [number for number, one in enumerate(plan.emitters) if hasattr(one, "select")]
    in_turn = np.resize(np.array(varying, np.int32), len(emitter))
    return np.where(np.isin(emitter, varying), emitter, in_turn)


def _remaining(plan: Plan, age: int) -> Decimal:
    """Return the part of a choice's weight that is left, with the same digits everywhere."""
    assert plan.breeding is not None
    return Decimal(2) ** (-Decimal(age) / Decimal(plan.breeding.half_life))


def _parents(
    plan: Plan, choices: Choices, rows: np.ndarray, weights: np.ndarray
) -> search.Elites:
    """Return chosen creatures as an archive of equally fit elites, curious by their weights."""
    none = search.no_elites(MAX_PARENTS, len(plan.measures), plan.genotype)

    def placed(before: Any, values: Any) -> Any:
        after = np.array(before)
        after[: len(rows)] = values
        return jnp.asarray(after)

    chosen = jax.tree.map(lambda x: x[rows], choices.genotypes)
    return replace(
        none,
        occupied=placed(none.occupied, True),
        curiosity=placed(none.curiosity, weights),
        genotypes=jax.tree.map(placed, none.genotypes, chosen),
    )
