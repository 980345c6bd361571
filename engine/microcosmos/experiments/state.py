"""The plan of a search, which never changes, and its state."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import inf
from typing import Any

import equinox as eqx
import jax
import numpy as np
from jaxtyping import Array, Float, Int, PRNGKeyArray, PyTree, UInt8

from .. import neat, search
from ..archive.poses import PoseStream
from ..genomes import Encoding, Genotype
from .epochs import Epochs, no_epochs
from .first import FirstEvaluations, no_first
from .named import Breeding, Choices, InitialCreatures, no_choices

CURVES = (
    "qd_score",
    "coverage",
    "best",
    "mean",
    "evaluations",
    "infeasible",
    "clipped",
    "corrected_qd_score",
    "corrected_coverage",
    "hit_rate",
)
"""Columns of the curves, in this order; the last three are NaN without reevaluation."""

N_CORRECTED = 3
"""Columns of `CURVES` from reevaluation."""

OUTCOMES = ("children", "inserted", "improved")
"""Counts of an emitter's children: all, those in new cells, those that replaced an elite.
Initial creatures are nobody's children."""

PREDICTIONS = ("fitness_error", "cell_hits", "feasible")
"""Figures of a generation's predictions: root mean square error of the fitness of feasible
creatures, share of creatures in the predicted cell, and mean predicted probability of being
feasible; NaN before the first prediction."""

ENDS = ("", "evaluations", "fitness", "device_hours")
"""Reasons for an end before the last generation; the first stands for none."""

MAX_INFEASIBLE = 256
"""Number of infeasible creatures to keep, the newest."""


@dataclass(frozen=True)
class Limits:
    """Limits that end a run before its last generation; see `spec.Stop`."""

    evaluations: float = inf
    device_hours: float = inf
    fitness: float = inf


@dataclass(frozen=True)
class Reevaluation:
    """When elites are reevaluated, under which conditions, and whether means decide; see
    `spec.Reevaluation`."""

    every: int
    samples: int
    spread: search.reevaluation.Spread
    size: tuple[int, int]
    """Size of the world, in cells."""
    decides: bool = False
    max_samples: int = 12
    max_error: float = 0.0


@dataclass(frozen=True)
class Screening:
    """Rounds of candidates, and how many are predicted; see `spec.Screening`."""

    rounds: int
    candidates: int
    unscreened: float
    regression: search.screening.Regression


@dataclass(frozen=True)
class Plan:
    """Everything about a run that follows from its spec and its device."""

    spec: str
    """The whole spec as JSON."""
    identity_template: Mapping[str, Any]
    """The identity that all creatures of the run share, without genes."""
    seed: int
    generations: int
    block: int
    descriptors: tuple[str, ...]
    container: search.Container
    encoding: Encoding
    emitters: tuple[search.Emitter, ...]
    counters: neat.Counters
    """The first numbers that no newcomer's gene has."""
    device: str
    limits: Limits = Limits()
    reevaluation: Reevaluation | None = None
    screening: Screening | None = None
    bandit: search.emitters.Bandit | None = None
    """What divides each batch among the emitters; None: their slots do."""
    feasible: bool = False
    """True if a creature at a limit, too fast or pushing itself is no elite."""
    force_free: bool = True
    """True if bodies cannot push themselves; if not, swimming may be an artefact."""

    measures: tuple[str, ...] = search.MEASURES
    """Names of the measures of every creature, in this order."""
    plugins: Mapping[str, Any] = field(default_factory=dict)
    """Versions of the plug-ins among them."""
    names: tuple[str, ...] = ()
    """Names of the emitters, each unique."""
    initial: InitialCreatures | None = None
    """Initial creatures; a file of the run also holds them."""
    breeding: Breeding | None = None
    """None if the search cannot descend from chosen creatures."""

    @property
    def decides(self) -> bool:
        """True if means decide which offspring enter."""
        return self.reevaluation is not None and self.reevaluation.decides

    @property
    def axes(self) -> tuple[search.Axis, ...]:
        return self.container.axes

    @property
    def cell_count(self) -> int:
        return self.container.count

    @property
    def batch(self) -> int:
        return sum(emitter.slots for emitter in self.emitters)

    @property
    def key(self) -> PRNGKeyArray:
        """Return the key that all others derive from."""
        return jax.random.key(self.seed, impl="threefry2x32")

    @property
    def genotype(self) -> Genotype:
        """Shapes and types of one genotype."""
        return jax.eval_shape(lambda: self.encoding.newcomer(key=self.key))


class Lineage(eqx.Module):
    """Parents and measures of each entry into the archive, in order."""

    creature: UInt8[np.ndarray, "entry 32"]
    parents: UInt8[np.ndarray, "entry 2 32"]
    """Zeros for none."""
    operator: Int[np.ndarray, "entry"]
    generation: Int[np.ndarray, "entry"]
    cell: Int[np.ndarray, "entry"]
    fitness: Float[np.ndarray, "entry"]
    descriptors: Float[np.ndarray, "entry axis"]


class Infeasible(eqx.Module):
    """Infeasible creatures, with the reasons."""

    generation: Int[np.ndarray, "row"]
    slot: Int[np.ndarray, "row"]
    status: Int[np.ndarray, "row"]
    genotypes: Genotype


class Screened(eqx.Module):
    """What screening has learned, and how well it predicted."""

    model: search.screening.Model
    predictions: Float[np.ndarray, "generation prediction"]
    """Columns of `PREDICTIONS`."""


def start_screening(screening: Screening) -> Screened:
    """Return the model before the first generation."""
    return Screened(screening.regression.init(), np.zeros((0, len(PREDICTIONS))))


class State(eqx.Module):
    """The input of the next generation, and the record of those before."""

    generation: int
    """Generations completed."""
    evaluations: int
    """Simulations of a creature: offspring, gradients and reevaluations."""
    infeasible: int
    container: search.Container
    """The plan's, or that of the machine on which the run began, with what it has learned."""
    elites: search.Elites
    counters: neat.Counters
    emitters: tuple[PyTree[Array], ...]
    """State of each emitter."""
    nearest_ancestors: UInt8[np.ndarray, "slot 2 32"]
    """The nearest recorded creatures of each slot of the last generation: itself if it entered,
    else its ancestors; zeros for none."""
    repeats: search.reevaluation.Repeats
    creatures: UInt8[np.ndarray, "cell 32"]
    """The SHA-256 of each cell's elite."""
    operators: Int[np.ndarray, "cell"]
    device_of: Int[np.ndarray, "cell"]
    """Index in `devices` of the device that measured each cell's elite."""
    curves: Float[np.ndarray, "generation curve"]
    outcomes: Int[np.ndarray, "generation emitter outcome"]
    ended: int
    """Index in `ENDS`."""
    device_seconds: float
    """Time of evaluation, summed over devices; used only for the limit on it."""
    lineage: Lineage
    failures: Infeasible
    choices: Choices
    """Chosen creatures that count so far."""
    poses: Mapping[int, PoseStream]
    """The pose stream of each cell's elite."""
    devices: tuple[str, ...] = eqx.field(static=True)
    """Kinds of device that computed the run, the present one last."""
    unrepeated: search.reevaluation.Repeats | None = None
    """`repeats` before a reevaluation that happened only because the run ended."""
    initial: InitialCreatures | None = None
    """The plan's; the first generations evaluate them."""
    screened: Screened | None = None
    """None without screening."""
    first: FirstEvaluations | None = None
    """None unless means decide."""
    fronts: Float[np.ndarray, "generation figure"] | None = None
    """Columns of `search.FrontFigures`; None without Pareto fronts."""
    epochs: Epochs | None = None
    """None unless axes are learned."""


def prolonged(state: State) -> State:
    """Return the last state of a run as it would be if more generations followed."""
    if state.unrepeated is None:
        return state
    early = np.sum(np.asarray(state.repeats.count) - np.asarray(state.unrepeated.count))
    evaluations, curves = state.evaluations - int(early), state.curves.copy()
    curves[-1, CURVES.index("evaluations")] = evaluations
    curves[-1, -N_CORRECTED:] = np.nan
    return replace(
        state,
        evaluations=evaluations,
        curves=curves,
        repeats=state.unrepeated,
        unrepeated=None,
    )


def start(plan: Plan) -> State:
    """Return the state before the first generation."""
    none, names = np.zeros(0, np.int32), np.zeros((0, 32), np.uint8)
    descriptors = np.zeros((0, len(plan.axes)), np.float32)
    no_figures = np.zeros((0, len(search.FrontFigures._fields)))
    no_genotypes = jax.tree.map(lambda x: np.zeros((0, *x.shape), x.dtype), plan.genotype)
    return State(
        generation=0,
        evaluations=0,
        infeasible=0,
        container=plan.container,
        elites=search.no_elites(plan.cell_count, len(plan.measures), plan.genotype),
        counters=plan.counters,
        emitters=search.emitters.begin(plan.emitters, key=plan.key),
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
        failures=Infeasible(none, none, none, no_genotypes),
        choices=no_choices(plan.genotype),
        poses={},
        devices=(plan.device,),
        initial=plan.initial,
        screened=plan.screening and start_screening(plan.screening),
        first=no_first(plan.cell_count, len(plan.measures)) if plan.decides else None,
        fronts=no_figures if isinstance(plan.container, search.Fronts) else None,
        epochs=no_epochs(plan.container),
    )
