"""Initial creatures: a search evaluates those of another run first, a batch at a time.

Their children fill the rest of the last such batch.
"""

from dataclasses import replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, UInt8

from ...genomes import Genotype
from ..emitters import NO_PARENT, OPERATORS, Children, Population
from ..insertion import Elites, no_elites
from ..loop import Leaf, Part, Plan, Turn
from .records import no_genotypes

INITIAL = -1
"""Number of the emitter of an initial creature."""


class Initial(eqx.Module):
    """Initial creatures, in the order of their names."""

    creature: UInt8[np.ndarray, "row 32"]
    genotypes: Genotype
    """Rows of NumPy arrays."""


def part(count: int, given: Initial | None = None) -> Part:
    """Return the part that evaluates `count` creatures first; a file of the run holds them."""

    def begin(plan: Plan) -> Initial:
        if given is None:
            raise ValueError(
                f"`search.initial` names {count} creatures, whose files are needed to begin"
            )
        return given

    return Part(
        name="initial",
        begin=begin,
        like=lambda plan: Initial(np.zeros((0, 32), np.uint8), no_genotypes(plan)),
        leaves={
            "creature": Leaf("row", "initial/creature"),
            "genotypes": Leaf("row", "initial/genomes"),
        },
        propose=_as_parents,
        amend=_evaluated_first,
    )


def _first(turn: Turn) -> int:
    """Return the number of initial creatures before this generation."""
    return turn.before.generation * turn.plan.batch


def _as_parents(own: Initial, turn: Turn) -> tuple[Initial, Turn]:
    """Let children descend from initial creatures until all of these are evaluated."""
    if _first(turn) >= len(own.creature):
        return own, turn
    plan, count = turn.plan, min(turn.plan.cell_count, len(own.creature))
    genotypes = jax.tree.map(lambda x: x[:count], own.genotypes)
    source = parents_of(plan, plan.cell_count, genotypes, np.ones(count, np.float32))
    names = turn.parts["lineage"].names.copy()
    names[: plan.cell_count] = 0
    names[:count] = own.creature[:count]
    # Those that are evaluated have the numbers behind, since they may outnumber the cells.
    names = np.concatenate([names, own.creature])
    return own, replace(turn, batch=replace(turn.batch, source=source, names=names))


def parents_of(
    plan: Plan, places: int, genotypes: Genotype, weights: Float[np.ndarray, "row"]
) -> Elites:
    """Return genotypes as an archive of equally fit elites, curious by their weights."""
    none, rows = no_elites(places, len(plan.measures), plan.genotype), len(weights)

    def placed(before: Any, values: Any) -> Any:
        # NumPy places them: JAX would compile again for each number of rows.
        after = np.array(before)
        after[:rows] = values
        return jnp.asarray(after)

    return replace(
        none,
        occupied=placed(none.occupied, True),
        curiosity=placed(none.curiosity, weights),
        genotypes=jax.tree.map(placed, none.genotypes, genotypes),
    )


def _evaluated_first(own: Initial, turn: Turn) -> tuple[Initial, Turn]:
    """Put the next initial creatures into the first slots."""
    plan, batch, first = turn.plan, turn.batch, _first(turn)
    places = np.arange(first, min(first + plan.batch, len(own.creature)))
    count = len(places)
    if not count:
        return own, turn

    def put(old: Any, new: Any) -> np.ndarray:
        return np.concatenate([np.asarray(new), np.asarray(old)[count:]])

    numbers = plan.cell_count + plan.batch + places
    parents = np.stack([numbers, np.full(count, NO_PARENT)], 1)
    new = Children(
        genotypes=jax.tree.map(lambda x: x[places], own.genotypes),
        parents=jnp.asarray(parents, jnp.int32),
        operator=jnp.full(count, OPERATORS.index("fork"), jnp.int32),
    )
    begins = np.cumsum([0, *(emitter.slots for emitter in plan.emitters[:-1])]).tolist()
    # An emitter must not learn from what it did not emit. A population may: its networks are
    # those that were evaluated in its slots.
    kept = {
        number: state
        for number, (state, slot) in enumerate(zip(turn.before.emitters, begins, strict=True))
        if slot < count and not isinstance(state, Population)
    }
    # Their parents are the originals, so the lineage goes through a fork.
    batch = replace(
        batch,
        children=jax.tree.map(put, batch.children, new),
        emitter=put(batch.emitter, np.full(count, INITIAL, np.int32)),
        kept=kept,
    )
    return own, replace(turn, batch=batch)
