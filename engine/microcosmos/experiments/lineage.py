"""Naming the creatures that enter the archive, and writing down where they come from."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import jax
import numpy as np

from .. import naming, search
from ..archive.report import Elite
from ..genomes import Genotype, take, write
from .state import Lineage, Plan, State

NOBODY = np.zeros(32, np.uint8)
"""The name of nobody."""


@dataclass(frozen=True)
class News:
    """What a generation changed in the host's part of the state."""

    elites: tuple[Elite, ...]
    creatures: np.ndarray
    operators: np.ndarray
    device_of: np.ndarray
    nearest_ancestors: np.ndarray
    lineage: Lineage


def record(
    plan: Plan,
    state: State,
    children: search.Children,
    evaluation: search.Evaluation,
    cells: np.ndarray,
    slots: np.ndarray,
    names: np.ndarray,
) -> News:
    """The elites of the slots that entered, and the records with them added.

    `names` are those of the creatures that parents are drawn from, by cell.
    """
    generation = state.generation + 1
    operator = np.asarray(children.operator)[slots]
    forebears = _forebears(names, state.nearest_ancestors, np.asarray(children.parents))
    parents = forebears[slots]
    fitness, measures = np.asarray(evaluation.fitness)[slots], np.asarray(evaluation.measures)
    measures = measures[slots]
    elites = tuple(
        _elite(
            plan,
            take(children.genotypes, slot),
            float(fitness[i]),
            measures[i],
            cell=int(cells[i]),
            generation=generation,
            operator=int(operator[i]),
            parents=parents[i],
            device=plan.device,
        )
        for i, slot in enumerate(slots.tolist())
    )
    parents[[not elite.parents for elite in elites]] = 0
    own = [np.frombuffer(bytes.fromhex(elite.creature), np.uint8) for elite in elites]
    creatures, operators = state.creatures.copy(), state.operators.copy()
    device_of = state.device_of.copy()
    operators[cells], device_of[cells] = operator, len(state.devices) - 1
    new = Lineage(
        creature=np.array(own, np.uint8).reshape(-1, 32),
        parents=parents,
        operator=operator.astype(np.int32),
        generation=np.full(len(slots), generation, np.int32),
        cell=cells.astype(np.int32),
        fitness=fitness,
        descriptors=measures[:, [axis.measure for axis in plan.axes]],
    )
    creatures[cells] = new.creature
    nearest_ancestors = forebears.copy()
    nearest_ancestors[slots] = 0
    nearest_ancestors[slots, 0] = new.creature
    lineage = jax.tree.map(lambda a, b: np.concatenate([a, b]), state.lineage, new)
    return News(elites, creatures, operators, device_of, nearest_ancestors, lineage)


def document(plan: Plan, state: State, cell: int) -> dict[str, Any]:
    """The creature file of a cell's elite."""
    elites = jax.tree.map(lambda x: np.asarray(x)[cell], state.elites)
    entry = np.flatnonzero(state.lineage.cell == cell)[-1]
    elite = _elite(
        plan,
        elites.genotypes,
        float(elites.fitness),
        elites.measures,
        cell=cell,
        generation=int(elites.generation),
        operator=int(state.operators[cell]),
        parents=state.lineage.parents[entry],
        device=state.devices[state.device_of[cell]],
    )
    return naming.document(json.loads(elite.identity), elite.measured, elite.provenance)


def identity(frame: Mapping[str, Any], genotype: Genotype) -> dict[str, Any]:
    """What a genotype is in the world, body and task of `frame`."""
    return {**frame, "genome": {**frame["genome"], **write(genotype)}}


def _forebears(
    names: np.ndarray, nearest_ancestors: np.ndarray, parents: np.ndarray
) -> np.ndarray:
    """Recorded creatures (slot, 2, 32) that the children of parents (slot, 2) descend from.

    A parent in the archive is recorded itself; one of the last generation may not be: then
    it is the nearest of its own forebears that is.
    """
    nearest = np.concatenate([names, nearest_ancestors[:, 0], NOBODY[None]])
    found = nearest[parents]  # −1, for no parent, finds nobody.
    alone = (parents[:, 1] == search.NO_PARENT) & (parents[:, 0] >= len(names))
    # An only parent that was not recorded passes both of its own forebears on.
    found[alone] = nearest_ancestors[parents[alone, 0] - len(names)]
    same = (found[:, 0] == found[:, 1]).all(-1)
    found[same, 1] = 0
    return found


def _elite(
    plan: Plan,
    genotype: Genotype,
    fitness: float,
    values: np.ndarray,
    *,
    cell: int,
    generation: int,
    operator: int,
    parents: np.ndarray,
    device: str,
) -> Elite:
    whole = identity(plan.frame, genotype)
    measures: dict[str, float] = dict(zip(plan.measures, values.tolist(), strict=True))
    descriptors = {name: measures[name] for name in plan.descriptors}
    creature = naming.name(whole)
    named = tuple(bytes(parent).hex() for parent in parents if parent.any())
    if search.OPERATORS[operator] == "fork":  # In its own world it is itself, not its child.
        named = tuple(name for name in named if name != creature)
    measured = {
        "fitness": fitness,
        "descriptors": descriptors,
        "measures": measures,
        "block": plan.block,
        "room": list(plan.encoding.room) if plan.encoding.room else None,
        "device": device,
        **({"plugins": dict(plan.plugins)} if plan.plugins else {}),
    }
    provenance = naming.provenance(
        search.OPERATORS[operator], generation=generation, parents=named, seed=plan.seed
    )
    return Elite(
        cell=cell,
        fitness=fitness,
        descriptors=tuple(descriptors.values()),
        measures=measures,
        creature=creature,
        identity=naming.canonical(whole),
        parents=named,
        operator=search.OPERATORS[operator],
        generation=generation,
        measured=measured,
        provenance=provenance,
    )
