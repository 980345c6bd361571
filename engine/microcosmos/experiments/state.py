"""What a quality-diversity run is: its plan, which never changes, and its state."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import equinox as eqx
import numpy as np
from jaxtyping import Float, Int, UInt8

from .. import neat, search
from ..genomes import CPPN, empty

CURVES = ("qd_score", "coverage", "best", "mean", "evaluations", "diverged")
"""Columns of the record of generations, in this order."""

KEPT = 256
"""How many diverged creatures are kept, the newest."""


@dataclass(frozen=True)
class Plan:
    """The numbers and names of a run, as its spec has them, and where it is computed."""

    spec: str
    """The whole spec as JSON."""
    frame: Mapping[str, Any]
    """The identity that all creatures of the run share; only genes are missing."""
    seed: int
    generations: int
    batch: int
    block: int
    variation: str
    cells: int
    descriptors: tuple[str, ...]
    axes: tuple[search.Axis, ...]
    genes: search.Genes
    device: str
    force_free: bool = True
    """Whether bodies cannot push themselves; if not, their swimming may be the solver's."""

    @property
    def room(self) -> tuple[int, int]:
        """Nodes and connections that a genome's arrays have room for."""
        return self.genes.max_nodes, self.genes.max_connections


class Lineage(eqx.Module):
    """One row for each entry into the archive, in order: who descends from whom."""

    creature: UInt8[np.ndarray, "entry 32"]
    parent: UInt8[np.ndarray, "entry 32"]
    """Zeros where there is none."""
    operator: Int[np.ndarray, "entry"]
    generation: Int[np.ndarray, "entry"]
    cell: Int[np.ndarray, "entry"]
    fitness: Float[np.ndarray, "entry"]
    descriptors: Float[np.ndarray, "entry axis"]


class Diverged(eqx.Module):
    """Creatures whose simulation failed, kept apart from the archive."""

    generation: Int[np.ndarray, "row"]
    slot: Int[np.ndarray, "row"]
    status: Int[np.ndarray, "row"]
    networks: CPPN


class State(eqx.Module):
    """Everything that the next generation depends on, and the record of those before."""

    generation: int
    """Generations completed."""
    evaluations: int
    diverged: int
    elites: search.Elites
    counters: neat.Counters
    creatures: UInt8[np.ndarray, "cell 32"]
    """The SHA-256 of each cell's elite."""
    operators: Int[np.ndarray, "cell"]
    origins: Int[np.ndarray, "cell"]
    """Which of `devices` measured each cell's elite."""
    curves: Float[np.ndarray, "generation curve"]
    lineage: Lineage
    quarantine: Diverged
    devices: tuple[str, ...] = eqx.field(static=True)
    """Kinds of device that computed the run, the present one last."""


def start(plan: Plan) -> State:
    """Before the first generation."""
    none, names = np.zeros(0, np.int32), np.zeros((0, 32), np.uint8)
    descriptors = np.zeros((0, len(plan.axes)), np.float32)
    return State(
        generation=0,
        evaluations=0,
        diverged=0,
        elites=search.no_elites(plan.cells, len(search.FEATURES), *plan.room),
        counters=neat.first_counters(plan.genes.inputs, plan.genes.outputs),
        creatures=np.zeros((plan.cells, 32), np.uint8),
        operators=np.zeros(plan.cells, np.int32),
        origins=np.zeros(plan.cells, np.int32),
        curves=np.zeros((0, len(CURVES))),
        lineage=Lineage(names, names, none, none, none, np.zeros(0, np.float32), descriptors),
        quarantine=Diverged(none, none, none, empty(*plan.room, (0,))),
        devices=(plan.device,),
    )
