"""Naming the creatures that enter the archive, and writing down where they come from."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import jax
import numpy as np

from .. import search
from ..archive import naming
from ..genomes import CPPN, take, to_genes
from ..version import VERSION
from .report import Elite
from .state import Lineage, Plan, State

NOBODY = np.zeros(32, np.uint8)


@dataclass(frozen=True)
class News:
    """What a generation changed in the host's part of the state."""

    elites: tuple[Elite, ...]
    creatures: np.ndarray
    operators: np.ndarray
    origins: np.ndarray
    lineage: Lineage


def record(
    plan: Plan,
    state: State,
    children: search.Children,
    evaluation: search.Evaluation,
    cells: np.ndarray,
    slots: np.ndarray,
) -> News:
    """The elites of the slots that entered, and the records with them added."""
    generation = state.generation + 1
    operator, origin = np.asarray(children.operator)[slots], np.asarray(children.parent)[slots]
    fitness, features = np.asarray(evaluation.fitness)[slots], np.asarray(evaluation.features)
    features = features[slots]
    parents = np.where((origin != search.NO_PARENT)[:, None], state.creatures[origin], NOBODY)
    elites = tuple(
        _elite(
            plan,
            take(children.networks, slot),
            float(fitness[i]),
            features[i],
            cell=int(cells[i]),
            generation=generation,
            operator=int(operator[i]),
            parent=parents[i],
            device=plan.device,
        )
        for i, slot in enumerate(slots.tolist())
    )
    names = [np.frombuffer(bytes.fromhex(elite.creature), np.uint8) for elite in elites]
    creatures, operators = state.creatures.copy(), state.operators.copy()
    origins = state.origins.copy()
    operators[cells], origins[cells] = operator, len(state.devices) - 1
    new = Lineage(
        creature=np.array(names, np.uint8).reshape(-1, 32),
        parent=parents,
        operator=operator.astype(np.int32),
        generation=np.full(len(slots), generation, np.int32),
        cell=cells.astype(np.int32),
        fitness=fitness,
        descriptors=features[:, [axis.feature for axis in plan.axes]],
    )
    creatures[cells] = new.creature
    lineage = jax.tree.map(lambda a, b: np.concatenate([a, b]), state.lineage, new)
    return News(elites, creatures, operators, origins, lineage)


def document(plan: Plan, state: State, cell: int) -> dict[str, Any]:
    """The creature file of a cell's elite."""
    elites = jax.tree.map(lambda x: np.asarray(x)[cell], state.elites)
    entry = np.flatnonzero(state.lineage.cell == cell)[-1]
    elite = _elite(
        plan,
        elites.networks,
        float(elites.fitness),
        elites.features,
        cell=cell,
        generation=int(elites.generation),
        operator=int(state.operators[cell]),
        parent=state.lineage.parent[entry],
        device=state.devices[state.origins[cell]],
    )
    return {
        "identity": json.loads(elite.identity),
        "sha256": elite.creature,
        "measured": elite.measured,
        "provenance": elite.provenance,
        "licence": naming.LICENCE,
    }


def identity(frame: Mapping[str, Any], network: CPPN) -> dict[str, Any]:
    """What a network is in the world, body and task of `frame`."""
    return {**frame, "genome": {**frame["genome"], **to_genes(network)}}


def _elite(
    plan: Plan,
    network: CPPN,
    fitness: float,
    values: np.ndarray,
    *,
    cell: int,
    generation: int,
    operator: int,
    parent: np.ndarray,
    device: str,
) -> Elite:
    whole = identity(plan.frame, network)
    features: dict[str, float] = dict(zip(search.FEATURES, values.tolist(), strict=True))
    descriptors = {name: features[name] for name in plan.descriptors}
    parents = (bytes(parent).hex(),) if parent.any() else ()
    measured = {
        "fitness": fitness,
        "descriptors": descriptors,
        "features": features,
        "block": plan.block,
        "room": list(plan.room),
        "device": device,
    }
    provenance = {
        "parents": list(parents),
        "operator": search.OPERATORS[operator],
        "generation": generation,
        "seed": plan.seed,
        "version": VERSION,
    }
    return Elite(
        cell=cell,
        fitness=fitness,
        descriptors=tuple(descriptors.values()),
        features=features,
        creature=naming.name(whole),
        identity=naming.canonical(whole),
        parents=parents,
        operator=search.OPERATORS[operator],
        generation=generation,
        measured=measured,
        provenance=provenance,
    )
