"""The search loop: propose, evaluate, insert, tell, learn, record.

With emitters that draw parents from the archive it is MAP-Elites (Mouret and Clune,
arXiv:1504.04909, 2015); an emitter with its own population only records in it. One generator
carries out a generation. It yields what has to be evaluated and gets the results, so its
driver chooses the devices: a run of the service, or `Search.ask` and `tell`. If the driver
closes it, nothing has happened: states are immutable.

An optional behaviour is a `Part`. The loop knows parts only by their moments.
"""

from collections.abc import Callable, Generator, Mapping
from contextlib import closing
from dataclasses import dataclass, field, replace
from math import inf
from typing import Any, NamedTuple, Protocol, cast, runtime_checkable

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PRNGKeyArray, PyTree

from ..archive.report import Elite
from ..genomes import Genotype
from ..neat import Counters
from .cells import Axis
from .containers import Container, refreshed
from .emitters import Children, Emitter, Outcome, begin, outcome
from .insertion import Elites, Inserted, candidates, no_elites

# A file holds the index, so a new reason goes behind the others.
ENDS = ("", "evaluations", "fitness", "device_hours")
"""Reasons for an end before the last generation; the first stands for none."""

OFFSPRING = "offspring"
"""Name of the program that evaluates a generation."""

Later = Any
"""A value that is None before its step of the generation."""


class Ask(NamedTuple):
    """A request of the loop: rows to evaluate with one of the plan's programs."""

    rows: PyTree[np.ndarray]
    """Arrays whose first axis counts what is evaluated."""
    program: str


@dataclass(frozen=True)
class Program:
    """A compiled program for the rows of an `Ask`."""

    run: Callable[..., Any]
    """Evaluates a block of rows."""
    block: int
    """Rows that one call evaluates."""
    pads: bool = True
    """False if fewer rows than a block are a block of their own."""
    after: Callable[[Any], Any] = lambda found: found
    """Host function applied to all results."""
    simulates: bool = True
    """True if a row is a simulation of a creature and counts as an evaluation."""
    local: bool = False
    """True if the rows are too quick to travel to other hosts."""


Moment = Callable[[Any, "Turn"], Any]
"""A part's function of its state and the generation in progress; returns both anew.

It is a plain function, or a generator that yields `Ask` and gets the results."""


@dataclass(frozen=True)
class Leaf:
    """The place in an archive file of one attribute of a part's state."""

    axis: str
    """The meaning of its rows: "cell" (only occupied ones are written), "row" or "slot"; "" for
    one value. Rows of "generation" and "entry" are only ever appended; the last may yet
    change."""
    path: str
    """Name in the file, with slashes."""
    optional: bool = False
    """True if it is left out while it is None or has no rows."""
    write: Callable[[Any, np.ndarray], Any] | None = None
    """Turns the attribute into arrays, given the occupied cells; None: it stays as it is."""
    read: Callable[[Mapping[str, Any], Mapping[str, str], np.ndarray], Any] | None = None
    """Reads the attribute from a file, its attributes and the occupied cells."""


@dataclass(frozen=True)
class Part:
    """An optional behaviour of the loop, with a state of its own.

    `propose` may choose where parents come from, or make the children itself; `amend` changes
    children before their evaluation; `placed` follows the insertion; `learn` comes after it and
    may ask for evaluations. Parts act in the order of the plan.
    """

    name: str
    begin: Callable[["Plan"], Any] = lambda plan: None
    """Return the state before the first generation. Raise `ValueError` if it cannot begin."""
    like: Callable[["Plan"], Any] | None = None
    """Return a state with the shapes of one in a file; None: `begin` does."""
    leaves: Mapping[str, Leaf] = field(default_factory=dict)
    """Attributes (or names) of the state that files hold; the others live one generation."""
    programs: Mapping[str, Program] = field(default_factory=dict)
    propose: Moment | None = None
    amend: Moment | None = None
    placed: Moment | None = None
    learn: Moment | None = None
    figures: Callable[[Any, "Turn"], Mapping[str, int | float]] | None = None
    """Return figures of the generation for its report."""
    prolong: Callable[[Any, "State"], tuple[Any, "State"]] | None = None
    """Return the state of the part, and of the run, if more generations follow its last one."""
    receive: Callable[[Any, "State", Any], Any] | None = None
    """Return the part's state after an event from outside, between generations."""
    asks_late: bool = False
    """True if `learn` asks: the old archive must stay valid until the end of the generation."""


@dataclass(frozen=True)
class Limits:
    """Limits that end a run before its last generation; see `spec.Stop`."""

    evaluations: int | float = inf
    device_hours: int | float = inf
    fitness: int | float = inf


class Settled(NamedTuple):
    """The archive after a generation, and what the emitters have learned of it."""

    container: Container
    elites: Elites
    emitters: tuple[PyTree[Array], ...]
    counters: Counters
    inserted: Inserted
    """In NumPy arrays."""
    infeasible: int
    """Evaluations that could not enter."""
    candidates: Elites | None = None


@runtime_checkable
class Steps(Protocol):
    """The compiled steps of a generation, which decide its bits."""

    def emit(
        self, state: "State", elites: Elites
    ) -> tuple[Children, tuple[PyTree[Array], ...], Counters]:
        """Return children of parents among `elites`, and emitters and counters after them."""
        ...

    def settle(self, turn: "Turn", *, keep: bool) -> Settled:
        """Insert the evaluated children and tell the emitters; `keep` the old archive valid."""
        ...


@dataclass(frozen=True)
class Programs:
    """The steps of a run: programs of their own, between which the host acts; a `Steps`."""

    emission: Callable[..., tuple[Children, tuple[PyTree[Array], ...], Counters]]
    """Children from the emitters' states, an archive, counters and a generation."""
    insert: Callable[..., tuple[Elites, Inserted]]
    overwrite: Callable[..., tuple[Elites, Inserted]]
    """As `insert`; the genotypes of the old archive may be overwritten."""
    credit: Callable[..., Float[Array, "cell"]]
    tell: Callable[[tuple[PyTree[Array], ...], Outcome], tuple[PyTree[Array], ...]]

    def emit(
        self, state: "State", elites: Elites
    ) -> tuple[Children, tuple[PyTree[Array], ...], Counters]:
        generation = jnp.asarray(state.generation)
        return self.emission(state.emitters, elites, state.counters, generation)

    def settle(self, turn: "Turn", *, keep: bool) -> Settled:
        state, batch, evaluation = turn.before, turn.batch, turn.evaluation
        number = state.generation + 1
        rows = candidates(
            number,
            batch.children.genotypes,
            jnp.asarray(evaluation.fitness),
            jnp.asarray(evaluation.measures),
            jnp.asarray(evaluation.status == 0),
        )
        container = refreshed(state.container, state.elites, rows, number)
        insert = self.insert if keep else self.overwrite
        elites, inserted = insert(state.elites, rows, container)
        if batch.source is None:  # Other parents than elites earn no credit in the archive.
            parents = batch.children.parents[:, 0]
            elites = replace(elites, curiosity=self.credit(elites, parents, inserted))
        emitters = self.tell(batch.emitters, outcome(rows, inserted))
        infeasible = int(np.count_nonzero(evaluation.status))
        inserted = jax.device_get(inserted)
        return Settled(container, elites, emitters, batch.counters, inserted, infeasible, rows)


@dataclass(frozen=True)
class Plan:
    """The constants of a search."""

    seed: int
    container: Container
    emitters: tuple[Emitter, ...]
    counters: Counters
    """The first numbers that no newcomer's gene has."""
    genotype: Genotype
    """Shapes and types of one genotype."""
    measures: tuple[str, ...]
    """Names of the measures of every evaluation, in this order."""
    steps: Steps
    evaluate: Program | None = None
    """Evaluates the offspring; None: the driver of the loop does it."""
    names: tuple[str, ...] = ()
    """Names of the emitters, each unique."""
    generations: int | float = inf
    limits: Limits = Limits()
    parts: tuple[Part, ...] = ()

    @property
    def axes(self) -> tuple[Axis, ...]:
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
        # Named, since `jax_default_prng_impl` of a user must not change what a seed gives.
        return jax.random.key(self.seed, impl="threefry2x32")

    @property
    def programs(self) -> Mapping[str, Program]:
        """Return the programs that devices run, by name."""
        own = {OFFSPRING: self.evaluate} if self.evaluate else {}
        return own | {n: one for part in self.parts for n, one in part.programs.items()}

    def simulates(self, program: str) -> bool:
        """Return whether a row of a program counts as an evaluation."""
        return program == OFFSPRING or self.programs[program].simulates

    def part(self, name: str) -> Part | None:
        """Return the part of a name, None if the search has none such."""
        return next((part for part in self.parts if part.name == name), None)


class State(eqx.Module):
    """The input of the next generation, and the record of those before."""

    generation: int
    """Generations completed."""
    evaluations: int
    """Simulations of a creature: offspring, and what parts asked for."""
    infeasible: int
    ended: int
    """Index in `ENDS`."""
    device_seconds: float
    """Time of evaluation, summed over devices; used only for the limit on it."""
    container: Container
    """The plan's, or that of the machine on which the run began, with what it has learned."""
    elites: Elites
    counters: Counters
    emitters: tuple[PyTree[Array], ...]
    """State of each emitter."""
    parts: Mapping[str, Any]
    """State of each part, by name."""
    devices: tuple[str, ...] = eqx.field(static=True, default=())
    """Kinds of device that computed the run, the present one last."""


@dataclass(frozen=True)
class Batch:
    """The children of a generation before their evaluation."""

    children: Later = None
    """The `Children`, in NumPy arrays, once an emitter or a part has made them."""
    emitters: tuple[PyTree[Array], ...] = ()
    """State of each emitter after emission."""
    counters: Later = None
    """The `Counters` after the genes of the children."""
    emitter: Later = None
    """The number of each slot's emitter, as an array; negative numbers stand for parts."""
    source: Elites | None = None
    """Other parents than the archive's elites."""
    names: np.ndarray | None = None
    """Names (row, 32) of the creatures that parent numbers index: those of cells, of the
    slots of the generation before, and of any others; None: those of the part `lineage`."""
    kept: Mapping[int, PyTree[Array]] = field(default_factory=dict)
    """Earlier states of emitters that must not learn from this batch, by their number."""


@dataclass(frozen=True)
class Turn:
    """A generation in progress."""

    plan: Plan
    before: State
    """The state when it began."""
    parts: Mapping[str, Any]
    """The parts' states so far."""
    batch: Batch = Batch()
    evaluation: Later = None
    """An `Evaluation`, or other results with fitness, measures and status."""
    settled: Later = None
    """The `Settled` archive."""
    after: Later = None
    """The `State` since the insertion; its parts are those of `parts`."""
    evaluations: int = 0
    """Simulations in this generation."""
    seconds: float = 0.0
    """Time that requests took."""
    elites: tuple[Elite, ...] = ()
    """New elites, for the report."""
    emptied: tuple[int, ...] = ()
    """Cells (or places) that lost their elite and have no new one."""
    figures: Mapping[str, int | float] = field(default_factory=dict)
    """Figures of all parts, once the generation is over."""

    @property
    def number(self) -> int:
        """Return the number of the generation, counted from 1."""
        return self.before.generation + 1

    @property
    def over(self) -> bool:
        """Return whether the run ends with this generation."""
        return bool(self.after.ended) or self.after.generation >= self.plan.generations


Asking = Generator[Ask, Any, Turn]


def start(plan: Plan, devices: tuple[str, ...] = ()) -> State:
    """Return the state before the first generation. Raise `ValueError` as parts do."""
    return _start(plan, devices, {part.name: part.begin(plan) for part in plan.parts})


def like(plan: Plan, devices: tuple[str, ...] = ()) -> State:
    """Return a state with the shapes of one in a file."""
    forms = {part.name: (part.like or part.begin)(plan) for part in plan.parts}
    return _start(plan, devices, forms)


def _start(plan: Plan, devices: tuple[str, ...], parts: Mapping[str, Any]) -> State:
    return State(
        generation=0,
        evaluations=0,
        infeasible=0,
        ended=0,
        device_seconds=0.0,
        container=plan.container,
        elites=no_elites(plan.cell_count, len(plan.measures), plan.genotype),
        counters=plan.counters,
        emitters=begin(plan.emitters, key=plan.key),
        parts=parts,
        devices=devices,
    )


def emitted(turn: Turn) -> Turn:
    """Return the turn with the children of all emitters."""
    plan, batch = turn.plan, turn.batch
    elites = turn.before.elites if batch.source is None else batch.source
    children, emitters, counters = plan.steps.emit(turn.before, elites)
    made = {"children": jax.device_get(children), "emitters": emitters, "counters": counters}
    return replace(turn, batch=replace(batch, **made, emitter=slots_of(plan)))


def slots_of(plan: Plan) -> np.ndarray:
    """Return the number of the emitter of each slot."""
    slots = [emitter.slots for emitter in plan.emitters]
    return np.repeat(np.arange(len(slots), dtype=np.int32), slots)


def generation(plan: Plan, state: State, clock: Callable[[], float] = float) -> Asking:
    """Carry out a generation: yield what to evaluate, get the results, return the turn.

    `clock` counts device seconds. Close the generator to drop the generation; the state stays
    valid then. After the end it must not be used again, since a large archive is overwritten.
    """
    turn = yield from proposed(plan, state, clock)
    turn = yield from _driven(_evaluated(turn), turn, clock)
    turn = _settled(turn)
    turn = yield from _moments("placed", turn, clock)
    turn = _with_end(turn)
    # Parts ask in `learn` whether the run is over, so the limits are tested before. They are
    # tested once more behind it: reevaluations may use up the budget.
    turn = yield from _moments("learn", turn, clock)
    return _finished(_with_end(turn))


def proposed(plan: Plan, state: State, clock: Callable[[], float] = float) -> Asking:
    """Make the children of the next generation, which are not evaluated yet."""
    turn = Turn(plan, state, dict(state.parts))
    turn = yield from _moments("propose", turn, clock)
    if turn.batch.children is None:
        turn = emitted(turn)
    return (yield from _moments("amend", turn, clock))


def _moments(moment: str, turn: Turn, clock: Callable[[], float]) -> Asking:
    """Let every part act that has this moment, in the order of the plan."""
    for part in turn.plan.parts:
        act = getattr(part, moment)
        if act is not None:
            turn = yield from _driven(_acted(part, act, turn), turn, clock)
    return turn


def _acted(part: Part, act: Moment, turn: Turn) -> Asking:
    done: Any = act(turn.parts[part.name], turn)
    if isinstance(done, Generator):
        state, turn = yield from cast(Generator[Ask, Any, tuple[Any, Turn]], done)
    else:
        state, turn = done
    return replace(turn, parts={**turn.parts, part.name: state})


def _evaluated(turn: Turn) -> Asking:
    evaluation = yield Ask(turn.batch.children.genotypes, OFFSPRING)
    return replace(turn, evaluation=evaluation)


def _driven(work: Asking, turn: Turn, clock: Callable[[], float]) -> Asking:
    """Pass requests on; count their simulations and their time."""
    answer, count, seconds = None, 0, 0.0
    while True:
        try:
            ask = work.send(answer)
        except StopIteration as done:
            turn = done.value
            break
        began = clock()
        # Only requests take device time; what the host does between them counts for no device.
        answer = yield ask
        seconds += clock() - began
        if turn.plan.simulates(ask.program):
            count += len(jax.tree.leaves(ask.rows)[0])
    turn = replace(turn, evaluations=turn.evaluations + count, seconds=turn.seconds + seconds)
    if turn.after is None:
        return turn
    return replace(turn, after=_counted(turn, turn.after))


def _counted(turn: Turn, after: State) -> State:
    return replace(
        after,
        evaluations=turn.before.evaluations + turn.evaluations,
        device_seconds=turn.before.device_seconds + turn.seconds,
    )


def _settled(turn: Turn) -> Turn:
    plan, before, batch = turn.plan, turn.before, turn.batch
    occupied = np.array(before.elites.occupied)  # A copy: the steps may overwrite the archive.
    # A part that asks late may yet be stopped, and the old state has to stay valid.
    settled = plan.steps.settle(turn, keep=any(part.asks_late for part in plan.parts))
    # An emitter whose slots initial creatures took must not learn from them
    # (tests/engine/experiments/test_offspring.py).
    emitters = tuple(batch.kept.get(i, one) for i, one in enumerate(settled.emitters))
    after = replace(
        before,
        generation=turn.number,
        infeasible=before.infeasible + settled.infeasible,
        container=settled.container,
        elites=settled.elites,
        counters=settled.counters,
        emitters=emitters,
    )
    lost = occupied & ~np.asarray(settled.elites.occupied)
    return replace(
        turn,
        settled=settled,
        after=_counted(turn, after),
        emptied=tuple(np.flatnonzero(lost).tolist()),
    )


def _with_end(turn: Turn) -> Turn:
    """Return the turn with the limit that it has reached; requests of parts count too."""
    after = turn.after
    return replace(turn, after=replace(after, ended=after.ended or _ended(turn.plan, after)))


def _ended(plan: Plan, state: State) -> int:
    """Return the index in `ENDS` of the limit that the state has reached, 0 if none."""
    limits, elites = plan.limits, state.elites
    best = np.max(np.where(elites.occupied, elites.fitness, -np.inf))
    reached = {
        "evaluations": state.evaluations >= limits.evaluations,
        "fitness": best >= limits.fitness,
        "device_hours": state.device_seconds >= 3600 * limits.device_hours,
    }
    return next((ENDS.index(name) for name, beyond in reached.items() if beyond), 0)


def _finished(turn: Turn) -> Turn:
    turn = replace(turn, after=replace(turn.after, parts=turn.parts))
    figures: dict[str, int | float] = {}
    for part in turn.plan.parts:
        if part.figures is not None:
            figures |= part.figures(turn.parts[part.name], turn)
    return replace(turn, figures=figures)


def drive(work: Asking, answer: Callable[[Ask], Any]) -> Turn:
    """Carry a generation out with a function that answers its requests.

    An exception from `answer` closes the generation, as if it had not begun.
    """
    # Closed with an error, the generator ends and no part keeps half a generation
    # (tests/engine/search/test_loop.py, "a driver that fails").
    with closing(work):
        answered = None
        while True:
            try:
                ask = work.send(answered)
            except StopIteration as done:
                return done.value
            answered = answer(ask)


def prolonged(plan: Plan, state: State) -> State:
    """Return the last state of a run as it would be if more generations followed."""
    before = state.evaluations
    for part in plan.parts:
        if part.prolong is not None:
            own, state = part.prolong(state.parts[part.name], state)
            state = replace(state, parts={**state.parts, part.name: own})
    if state.evaluations < before:  # Those taken back may alone have reached the limit.
        state = replace(state, ended=_ended(plan, state))
    return state


def received(plan: Plan, state: State, name: str, event: Any) -> State:
    """Return the state after an event from outside, which the part of this name receives.

    Raise `ValueError` if the search has no such part, or as the part does.
    """
    part = plan.part(name)
    if part is None or part.receive is None:
        raise ValueError(f"the search must have a part that receives {name!r}, it has none")
    own = part.receive(state.parts[name], state, event)
    return replace(state, parts={**state.parts, name: own})
