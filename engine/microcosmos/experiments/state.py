"""What a search is: its plan, which never changes, and its state."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import inf
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, PRNGKeyArray, PyTree, UInt8

from .. import neat, search
from ..genomes import Encoding, Genotype
from ..search.emitters.population import Neat as PopulationEmitter

CURVES = (
    "qd_score",
    "coverage",
    "best",
    "mean",
    "evaluations",
    "diverged",
    "clipped",
    "corrected_qd_score",
    "corrected_coverage",
    "hit_rate",
)
"""Columns of the record of generations, in this order; the last three are NaN until elites
are evaluated again."""

N_CORRECTED = 3
"""So many of them."""

OUTCOMES = ("children", "inserted", "improved")
"""What becomes of an emitter's children: how many there were, entered an empty cell, and
replaced an elite."""

ENDS = ("", "evaluations", "fitness", "device_hours")
"""Why a run ended before its generations were through."""

BEFORE = 2**32 - 1
"""Stands for the generation before the first where keys are derived."""

MAX_DIVERGED = 256
"""How many diverged creatures are kept, the newest."""


@dataclass(frozen=True)
class Limits:
    """When a run ends before its generations are through; see `spec.Stop`."""

    evaluations: float = inf
    device_hours: float = inf
    fitness: float = inf


@dataclass(frozen=True)
class Reevaluation:
    """When elites are evaluated again, and under which conditions."""

    every: int
    samples: int
    spread: search.reevaluation.Spread
    size: tuple[int, int]
    """Of the world, in cells."""


class InitialCreatures(eqx.Module):
    """Creatures that a search begins from, in the order of their names."""

    creature: UInt8[np.ndarray, "row 32"]
    genotypes: Genotype
    """Rows of NumPy arrays."""


@dataclass(frozen=True)
class Plan:
    """The numbers and names of a run, as its spec has them, and where it is computed."""

    spec: str
    """The whole spec as JSON."""
    frame: Mapping[str, Any]
    """The identity that all creatures of the run share; only genes are missing."""
    seed: int
    generations: int
    block: int
    descriptors: tuple[str, ...]
    cells: search.Cells
    encoding: Encoding
    emitters: tuple[search.Emitter, ...]
    counters: neat.Counters
    """Numbers after the genes of newcomers."""
    device: str
    limits: Limits = Limits()
    reevaluation: Reevaluation | None = None
    force_free: bool = True
    """Whether bodies cannot push themselves; if not, their swimming may be the solver's."""

    measures: tuple[str, ...] = search.MEASURES
    """What is recorded of every creature, in this order."""
    plugins: Mapping[str, Any] = field(default_factory=dict)
    """Versions of the plug-ins among them."""
    names: tuple[str, ...] = ()
    """What the emitters are called, each by a name of its own."""
    initial: InitialCreatures | None = None
    """What it begins from; a file of the run has it too."""

    @property
    def axes(self) -> tuple[search.Axis, ...]:
        """The archive's descriptors."""
        return self.cells.axes

    @property
    def cell_count(self) -> int:
        """Cells of the archive."""
        return self.cells.count

    @property
    def batch(self) -> int:
        """Creatures of a generation."""
        return sum(emitter.slots for emitter in self.emitters)

    @property
    def key(self) -> PRNGKeyArray:
        """What all randomness is derived from."""
        return jax.random.key(self.seed, impl="threefry2x32")

    @property
    def genotype(self) -> Genotype:
        """Shapes and types of one genotype."""
        return jax.eval_shape(lambda: self.encoding.newcomer(key=self.key))


class Lineage(eqx.Module):
    """One row for each entry into the archive, in order: who descends from whom."""

    creature: UInt8[np.ndarray, "entry 32"]
    parents: UInt8[np.ndarray, "entry 2 32"]
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
    genotypes: Genotype


class State(eqx.Module):
    """Everything that the next generation depends on, and the record of those before."""

    generation: int
    """Generations completed."""
    evaluations: int
    diverged: int
    cells: search.Cells
    """The plan's, or as they were where the run began."""
    elites: search.Elites
    counters: neat.Counters
    emitters: tuple[PyTree[Array], ...]
    """What each emitter has learnt."""
    nearest_ancestors: UInt8[np.ndarray, "slot 2 32"]
    """Of each slot of the last generation, the recorded creatures nearest to it: itself where
    it entered, else its forebears; zeros where there are none."""
    repeats: search.reevaluation.Repeats
    creatures: UInt8[np.ndarray, "cell 32"]
    """The SHA-256 of each cell's elite."""
    operators: Int[np.ndarray, "cell"]
    device_of: Int[np.ndarray, "cell"]
    """Which of `devices` measured each cell's elite."""
    curves: Float[np.ndarray, "generation curve"]
    outcomes: Int[np.ndarray, "generation emitter outcome"]
    ended: int
    """The place in `ENDS` of why the run ended."""
    device_seconds: float
    """What evaluation took, all devices added up; never decides anything unless asked to."""
    lineage: Lineage
    quarantine: Diverged
    devices: tuple[str, ...] = eqx.field(static=True)
    """Kinds of device that computed the run, the present one last."""
    unrepeated: search.reevaluation.Repeats | None = None
    """Where elites were evaluated again only because the run ends: `repeats` before that."""
    initial: InitialCreatures | None = None
    """The plan's; creatures that it has room for in each generation are evaluated first."""


def prolonged(state: State) -> State:
    """The last state of a run as it would be in one of more generations."""
    if state.unrepeated is None:
        return state
    curves = state.curves.copy()
    curves[-1, -N_CORRECTED:] = np.nan
    return replace(state, curves=curves, repeats=state.unrepeated, unrepeated=None)


def start(plan: Plan) -> State:
    """Before the first generation."""
    none, names = np.zeros(0, np.int32), np.zeros((0, 32), np.uint8)
    descriptors = np.zeros((0, len(plan.axes)), np.float32)
    nobody = jax.tree.map(lambda x: np.zeros((0, *x.shape), x.dtype), plan.genotype)
    keys = jax.random.split(jax.random.fold_in(plan.key, BEFORE), len(plan.emitters))
    pairs = zip(plan.emitters, keys, strict=True)
    emitters = tuple(_founded(plan, e, e.init(key=key)) for e, key in pairs)
    return State(
        generation=0,
        evaluations=0,
        diverged=0,
        cells=plan.cells,
        elites=search.no_elites(plan.cell_count, len(plan.measures), plan.genotype),
        counters=plan.counters,
        emitters=emitters,
        nearest_ancestors=np.zeros((plan.batch, 2, 32), np.uint8),
        repeats=search.reevaluation.no_repeats(plan.cell_count, len(plan.measures)),
        creatures=np.zeros((plan.cell_count, 32), np.uint8),
        operators=np.zeros(plan.cell_count, np.int32),
        device_of=np.zeros(plan.cell_count, np.int32),
        curves=np.zeros((0, len(CURVES))),
        outcomes=np.zeros((0, len(plan.emitters), len(OUTCOMES)), np.int64),
        ended=0,
        device_seconds=0.0,
        lineage=Lineage(
            creature=names,
            parents=np.zeros((0, 2, 32), np.uint8),
            operator=none,
            generation=none,
            cell=none,
            fitness=np.zeros(0, np.float32),
            descriptors=descriptors,
        ),
        quarantine=Diverged(none, none, none, nobody),
        devices=(plan.device,),
        initial=plan.initial,
    )


def _founded(plan: Plan, emitter: search.Emitter, kept: PyTree[Array]) -> PyTree[Array]:
    """What an emitter keeps; a population begins with what the search begins from."""
    if plan.initial is None or not isinstance(emitter, PopulationEmitter):
        return kept
    networks = jax.tree.map(jnp.asarray, plan.initial.genotypes)
    return emitter.founded(kept, networks)
