"""Who descends from whom: every elite there ever was, with its parent and operator."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import equinox as eqx
import jax
import numpy as np
from jaxtyping import Array, Float, Int, UInt8

from .. import search
from ..archive import naming
from ..genomes import CPPN, take, to_genes
from ..version import VERSION
from .report import Elite

if TYPE_CHECKING:
    from .quality_diversity import QualityDiversity, State

NOBODY = np.zeros(32, np.uint8)


class Lineage(eqx.Module):
    """One row for each entry into the archive, in order."""

    creature: UInt8[Array, "entry 32"]
    parent: UInt8[Array, "entry 32"]
    """Zeros where there is none."""
    operator: Int[Array, "entry"]
    generation: Int[Array, "entry"]
    cell: Int[Array, "entry"]
    fitness: Float[Array, "entry"]
    descriptors: Float[Array, "entry axis"]

    @staticmethod
    def empty(axes: int) -> Lineage:
        """Nobody yet."""
        names, numbers = np.zeros((0, 32), np.uint8), np.zeros(0, np.int32)
        values = np.zeros((0, axes), np.float32)
        return Lineage(names, names, numbers, numbers, numbers, np.zeros(0, np.float32), values)


@dataclass(frozen=True)
class News:
    """What a generation changed in the host's part of the state."""

    elites: tuple[Elite, ...]
    creatures: np.ndarray
    operators: np.ndarray
    lineage: Lineage


def identity(frame: Mapping[str, Any], network: CPPN) -> dict[str, Any]:
    """What a network is in the world, body and task of `frame`."""
    return {**frame, "genome": {**frame["genome"], **to_genes(network)}}


def record(
    experiment: QualityDiversity,
    state: State,
    children: search.Children,
    evaluation: search.Evaluation,
    cells: np.ndarray,
    slots: np.ndarray,
) -> News:
    """Name the creatures that entered and write down where they come from."""
    names = state.creatures.copy()
    operators = state.operators.copy()
    parents = [
        state.creatures[cell] if cell != search.NO_PARENT else NOBODY
        for cell in children.parent[slots].tolist()
    ]
    elites = []
    for cell, slot, parent in zip(cells.tolist(), slots.tolist(), parents, strict=True):
        elite = _elite(experiment, state.generation, children, evaluation, cell, slot, parent)
        elites.append(elite)
        names[cell] = np.frombuffer(bytes.fromhex(elite.creature), np.uint8)
        operators[cell] = children.operator[slot]
    columns = [evaluation.features[slots, axis.feature] for axis in experiment.axes]
    new = Lineage(
        creature=names[cells],
        parent=np.array(parents, np.uint8).reshape(-1, 32),
        operator=children.operator[slots].astype(np.int32),
        generation=np.full(len(slots), state.generation, np.int32),
        cell=cells.astype(np.int32),
        fitness=evaluation.fitness[slots],
        descriptors=np.stack(columns, 1),
    )
    lineage = jax.tree.map(lambda a, b: np.concatenate([a, b]), state.lineage, new)
    return News(tuple(elites), names, operators, lineage)


def _elite(experiment, generation, children, evaluation, cell, slot, parent) -> Elite:
    plan, genes = experiment.plan, experiment.genes
    whole = identity(plan.frame, take(children.networks, slot))
    values = evaluation.features[slot].tolist()
    features = dict(zip(search.FEATURES, values, strict=True))
    descriptors = {name: features[name] for name in plan.descriptors}
    fitness = float(evaluation.fitness[slot])
    parents = (bytes(parent).hex(),) if parent.any() else ()
    operator = search.OPERATORS[int(children.operator[slot])]
    return Elite(
        cell=cell,
        fitness=fitness,
        descriptors=tuple(descriptors.values()),
        features=features,
        creature=naming.name(whole),
        identity=naming.canonical(whole),
        parents=parents,
        operator=operator,
        generation=generation,
        measured={
            "fitness": fitness,
            "descriptors": descriptors,
            "features": features,
            "block": plan.block,
            "room": [genes.max_nodes, genes.max_connections],
            "device": experiment.device,
        },
        provenance={
            "parents": list(parents),
            "operator": operator,
            "generation": generation,
            "seed": plan.seed,
            "version": VERSION,
        },
    )
