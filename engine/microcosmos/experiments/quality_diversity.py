"""MAP-Elites (Mouret and Clune, arXiv:1504.04909, 2015) over CPPN-controlled swimmers."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, UInt8

from .. import neat, search
from ..genomes import CPPN, empty
from . import archive_file
from .lineage import Lineage, record
from .report import Report

CURVES = ("qd_score", "coverage", "best", "mean", "evaluations", "diverged")


class Diverged(eqx.Module):
    """Creatures whose simulation failed, kept apart; the newest `KEPT` of them."""

    generation: Int[Array, "row"]
    slot: Int[Array, "row"]
    status: Int[Array, "row"]
    networks: CPPN


KEPT = 256


class State(eqx.Module):
    """Everything that the next generation depends on, and the record of those before."""

    generation: int
    """Generations completed."""
    evaluations: int
    diverged: int
    elites: search.Elites
    counters: neat.Counters
    creatures: UInt8[Array, "cell 32"]
    """The SHA-256 of each cell's elite."""
    operators: Int[Array, "cell"]
    curves: Float[Array, "generation curve"]
    lineage: Lineage
    quarantine: Diverged
    devices: tuple[str, ...] = eqx.field(static=True, default=())
    """Kinds of device in the file that the run was taken up from."""


@dataclass(frozen=True)
class Programs:
    """The compiled parts of a generation."""

    newcomers: Callable[[Int[Array, ""]], search.Children]
    vary: Callable[..., tuple[search.Children, neat.Counters]]
    evaluate_block: Callable[[CPPN], search.Evaluation]
    insert: Callable[[search.Elites, search.Elites], tuple]


@dataclass(frozen=True)
class Plan:
    """The numbers and names of a run, as its spec has them."""

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


@dataclass(frozen=True)
class QualityDiversity:
    """A quality-diversity run, driven by whoever holds it."""

    plan: Plan
    axes: tuple[search.Axis, ...]
    genes: search.Genes
    programs: Programs
    device: str

    def init(self) -> State:
        """Before the first generation."""
        room = self.genes.max_nodes, self.genes.max_connections
        cells = self.plan.cells
        none = np.zeros(0, np.int32)
        return State(
            generation=0,
            evaluations=0,
            diverged=0,
            elites=search.no_elites(cells, len(search.FEATURES), *room),
            counters=neat.first_counters(self.genes.inputs, self.genes.outputs),
            creatures=np.zeros((cells, 32), np.uint8),
            operators=np.zeros(cells, np.int32),
            curves=np.zeros((0, len(CURVES))),
            lineage=Lineage.empty(len(self.axes)),
            quarantine=Diverged(none, none, none, empty(*room, (0,))),
        )

    def done(self, state: State) -> bool:
        """Whether all generations are completed."""
        return state.generation >= self.plan.generations

    def generation(self, state: State) -> int:
        """Generations completed."""
        return state.generation

    def advance(
        self, state: State, stop: Callable[[], bool] = lambda: False
    ) -> tuple[State, Report]:
        """One generation: vary, evaluate by blocks, insert.

        Raises `Stopped` where `stop()` says so between blocks; `state` stays as it was.
        """
        children, counters = self._vary(state)
        children = jax.device_get(children)
        evaluation = search.evaluate_blocks(
            self.programs.evaluate_block,
            children.networks,
            block=self.plan.block,
            stop=stop,
        )
        candidates = self._candidates(state.generation, children, evaluation)
        elites, entered, cells = self.programs.insert(state.elites, candidates)
        slots = np.flatnonzero(np.asarray(entered))
        news = record(self, state, children, evaluation, np.asarray(cells)[slots], slots)
        failed = np.flatnonzero(evaluation.status)
        state = replace(
            state,
            generation=state.generation + 1,
            evaluations=state.evaluations + len(evaluation.fitness),
            diverged=state.diverged + len(failed),
            elites=elites,
            counters=counters,
            creatures=news.creatures,
            operators=news.operators,
            lineage=news.lineage,
            quarantine=_set_apart(state, children.networks, evaluation.status, failed),
        )
        row = self._curves(state)
        state = replace(state, curves=np.concatenate([state.curves, row[None]]))
        values = dict(zip(CURVES, row.tolist(), strict=True))
        values |= {name: int(values[name]) for name in ("evaluations", "diverged")}
        return state, Report(state.generation, **values, elites=news.elites)

    def save(self, state: State) -> bytes:
        """The archive file, from which the run can also be taken up again."""
        return archive_file.save(self, state)

    def restore(self, data: bytes, *, other_device: bool = False) -> State:
        """The state in an archive file of the same spec.

        Raises `ValueError` for another spec or format, and for another kind of device
        unless `other_device` allows it: from there on bits may differ, and the file says so.
        """
        return archive_file.restore(self, data, other_device=other_device)

    def _vary(self, state: State) -> tuple[search.Children, neat.Counters]:
        generation = jnp.asarray(state.generation)
        if state.generation == 0 or self.plan.variation == "random":
            return self.programs.newcomers(generation), state.counters
        return self.programs.vary(state.elites, state.counters, generation)

    def _candidates(self, generation, children, evaluation) -> search.Elites:
        batch = len(evaluation.fitness)
        return search.Elites(
            occupied=evaluation.status == 0,
            fitness=evaluation.fitness,
            features=evaluation.features,
            generation=np.full(batch, generation, np.int32),
            slot=np.arange(batch, dtype=np.int32),
            digest=np.zeros((batch, 2), np.uint32),  # `insert` computes it.
            networks=children.networks,
        )

    def _curves(self, state: State) -> np.ndarray:
        fitness = np.asarray(state.elites.fitness, np.float64)
        fitness = fitness[np.asarray(state.elites.occupied)]
        best, mean = (fitness.max(), fitness.mean()) if len(fitness) else (0.0, 0.0)
        coverage = len(fitness) / self.plan.cells
        return np.array(
            [fitness.sum(), coverage, best, mean, state.evaluations, state.diverged]
        )


def _set_apart(
    state: State, networks: CPPN, status: np.ndarray, failed: np.ndarray
) -> Diverged:
    generation = np.full(len(failed), state.generation, np.int32)
    chosen = jax.tree.map(lambda x: np.asarray(x)[failed], networks)
    new = Diverged(generation, failed.astype(np.int32), status[failed].astype(np.int32), chosen)
    return jax.tree.map(lambda a, b: np.concatenate([a, b])[-KEPT:], state.quarantine, new)
