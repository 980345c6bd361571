"""Names and parents of the creatures that enter the archive."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import jax
import numpy as np

from .. import naming, search
from ..archive.poses import PoseStream, decode
from ..archive.report import Elite
from ..genomes import Genotype, take, write
from .deciding import Decided
from .state import Lineage, Plan, State

NO_NAME = np.zeros(32, np.uint8)
"""The name that stands for no creature."""


def record(
    plan: Plan,
    state: State,
    children: search.Children,
    decided: Decided,
    inserted: search.Inserted,
    names: np.ndarray,
) -> tuple[State, tuple[Elite, ...]]:
    """Return the state with the new elites recorded, and those elites.

    `names` are the creatures that parents are drawn from, by cell.
    """
    slots = np.flatnonzero(inserted.entered)
    cells = np.asarray(inserted.cell)[slots]
    ancestors = _ancestors_of(names, state.nearest_ancestors, np.asarray(children.parents))
    elites = tuple(
        _new_elite(plan, state, children, decided, ancestors, slot, cell)
        for slot, cell in zip(slots.tolist(), cells.tolist(), strict=True)
    )
    new = _entries(plan, elites, ancestors[slots])
    creatures, operators = state.creatures.copy(), state.operators.copy()
    device_of, nearest_ancestors = state.device_of.copy(), ancestors.copy()
    operators[cells], device_of[cells] = new.operator, len(state.devices) - 1
    creatures[cells] = new.creature
    nearest_ancestors[slots] = 0
    nearest_ancestors[slots, 0] = new.creature
    lineage = jax.tree.map(lambda a, b: np.concatenate([a, b]), state.lineage, new)
    poses = {elite.cell: decode(elite.poses) for elite in elites if elite.poses}
    return replace(
        state,
        creatures=creatures,
        operators=operators,
        device_of=device_of,
        nearest_ancestors=nearest_ancestors,
        lineage=lineage,
        poses={**state.poses, **poses},
        first=state.first and state.first.replaced(cells, decided.columns(slots)),
    ), elites


def without(state: State, emptied: tuple[int, ...]) -> State:
    """Return the state without records of the elites of places that are empty now."""
    if not emptied:
        return state
    creatures, operators = state.creatures.copy(), state.operators.copy()
    device_of, lost = state.device_of.copy(), list(emptied)
    creatures[lost], operators[lost], device_of[lost] = 0, 0, 0
    poses = {cell: one for cell, one in state.poses.items() if cell not in emptied}
    return replace(
        state, creatures=creatures, operators=operators, device_of=device_of, poses=poses
    )


def _new_elite(
    plan: Plan,
    state: State,
    children: search.Children,
    decided: Decided,
    ancestors: np.ndarray,
    slot: int,
    cell: int,
) -> Elite:
    first, mean = decided.first, decided.mean
    return _elite(
        plan,
        take(children.genotypes, slot),
        float(first.fitness[slot]),
        np.asarray(first.measures[slot]),
        competing=(float(mean.fitness[slot]), np.asarray(mean.measures[slot])),
        cell=cell,
        generation=state.generation + 1,
        operator=int(np.asarray(children.operator)[slot]),
        parents=ancestors[slot],
        device=plan.device,
        poses=jax.tree.map(lambda x: x[slot], first.poses),
    )


def _entries(plan: Plan, elites: tuple[Elite, ...], parents: np.ndarray) -> Lineage:
    """Return the entries of new elites in the lineage; `parents` are (elite, 2, 32)."""
    parents[[not elite.parents for elite in elites]] = 0
    names = [np.frombuffer(bytes.fromhex(elite.creature), np.uint8) for elite in elites]
    operators = [search.OPERATORS.index(elite.operator) for elite in elites]
    measured = [elite.descriptors for elite in elites]
    return Lineage(
        creature=np.array(names, np.uint8).reshape(-1, 32),
        parents=parents,
        operator=np.array(operators, np.int32),
        generation=np.array([elite.generation for elite in elites], np.int32),
        cell=np.array([elite.cell for elite in elites], np.int32),
        fitness=np.array([elite.fitness for elite in elites], np.float32),
        descriptors=np.array(measured, np.float32).reshape(-1, len(plan.axes)),
    )


def document(plan: Plan, state: State, cell: int) -> dict[str, Any]:
    """Return the creature file of a cell's elite."""
    elites = jax.tree.map(lambda x: np.asarray(x)[cell], state.elites)
    entry = np.flatnonzero(state.lineage.cell == cell)[-1]
    competing, first = (float(elites.fitness), elites.measures), state.first
    fitness, measures = (
        (float(first.fitness[cell]), first.measures[cell]) if first else competing
    )
    elite = _elite(
        plan,
        elites.genotypes,
        fitness,
        measures,
        competing=competing,
        cell=cell,
        generation=int(elites.generation),
        operator=int(state.operators[cell]),
        parents=state.lineage.parents[entry],
        device=state.devices[state.device_of[cell]],
    )
    return naming.document(json.loads(elite.identity), elite.measured, elite.provenance)


def identity(template: Mapping[str, Any], genotype: Genotype) -> dict[str, Any]:
    """Return the identity of a genotype in the world, body and task of `template`."""
    return {**template, "genome": {**template["genome"], **write(genotype)}}


def measurement(
    fitness: float,
    measures: Mapping[str, float],
    descriptors: Iterable[str] = (),
    *,
    block: int,
    device: str,
    room: tuple[int, int] | None = None,
    plugins: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Return the part `measured` of a creature file."""
    return {
        "fitness": fitness,
        "descriptors": {name: measures[name] for name in descriptors},
        "measures": measures,
        "block": block,
        "room": list(room) if room else None,
        "device": device,
        **({"plugins": dict(plugins)} if plugins else {}),
    }


def _ancestors_of(
    names: np.ndarray, nearest_ancestors: np.ndarray, parents: np.ndarray
) -> np.ndarray:
    """Return the nearest recorded ancestors (slot, 2, 32) of children of parents (slot, 2).

    A parent from the archive is recorded. A parent from the last generation may not be: then
    its own nearest recorded ancestors take its place.
    """
    nearest = np.concatenate([names, nearest_ancestors[:, 0], NO_NAME[None]])
    found = nearest[parents]  # −1, for no parent, finds the last row.
    alone = (parents[:, 1] == search.NO_PARENT) & (parents[:, 0] >= len(names))
    # A single parent that was not recorded passes on both of its ancestors.
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
    competing: tuple[float, np.ndarray],
    cell: int,
    generation: int,
    operator: int,
    parents: np.ndarray,
    device: str,
    poses: search.Poses | None = None,
) -> Elite:
    whole = identity(plan.identity_template, genotype)
    measures: dict[str, float] = dict(zip(plan.measures, values.tolist(), strict=True))
    creature = naming.name(whole)
    named = tuple(bytes(parent).hex() for parent in parents if parent.any())
    if search.OPERATORS[operator] == "fork":  # It may be that creature.
        named = tuple(name for name in named if name != creature)
    measured = measurement(
        fitness,
        measures,
        plan.descriptors,
        block=plan.block,
        room=plan.encoding.room,
        device=device,
        plugins=plan.plugins,
    )
    provenance = naming.provenance(
        search.OPERATORS[operator], generation=generation, parents=named, seed=plan.seed
    )
    mean, means = competing
    return Elite(
        cell=cell,
        fitness=mean,
        descriptors=tuple(means[[axis.measure for axis in plan.axes]].tolist()),
        measures=measures,
        creature=creature,
        identity=naming.canonical(whole),
        parents=named,
        operator=search.OPERATORS[operator],
        generation=generation,
        measured=measured,
        provenance=provenance,
        poses=None if poses is None else pose_stream(plan, poses, creature).encode(),
    )


def pose_stream(plan: Plan, poses: search.Poses, creature: str) -> PoseStream:
    """Return the pose stream of one creature; its nodes are those that have grown."""
    spec, present, last = json.loads(plan.spec), poses.present, poses.window
    edges = np.asarray(poses.edges)
    edges = edges[np.all(present[edges], 1)]
    return PoseStream(
        positions=np.asarray(poses.positions)[:, present],
        path=np.asarray(poses.path),
        origin=(float(poses.origin[0]), float(poses.origin[1])),
        scale=float(poses.scale),
        edges=(np.cumsum(present) - 1)[edges].astype(np.int32),
        start=int(last.start),
        stop=int(last.stop),
        strokes=int(last.strokes),
        steps=spec["task"]["steps"],
        size=(spec["world"]["width"], spec["world"]["height"]),
        length=float(poses.length),
        creature=creature,
    )
