"""A search of your own: ask for genotypes, tell their fitness and measures.

Genotypes are vectors within bounds, or networks. The search drives the loop of every run
(`loop.generation`) without simulations. Emission is one compiled program, insertion with all
that emitters learn another; `run` compiles both into one.
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from fractions import Fraction
from functools import partial
from hashlib import sha256
from numbers import Real
from typing import Any, NamedTuple, Protocol, cast, runtime_checkable

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int, PRNGKeyArray, PyTree

from ..archive import file
from ..bounds import refuse_uncountable
from ..genomes import CPPN, Genotype, Graph, Vector, evaluate, minimal
from ..invalid import InvalidField
from ..neat import Counters, first_counters
from ..version import VERSION
from . import loop, state_file
from .cells import Voronoi
from .containers import (
    Container,
    Survival,
    best_of_cells,
    cells_of,
    insert,
    measured_axes,
    needed_columns,
    refreshed,
)
from .emitters import (
    OPERATORS,
    Children,
    CmaMae,
    Emitter,
    IsoLine,
    Learner,
    Neat,
    PopulationNeat,
    credit,
    emit,
    outcome,
    tell,
)
from .insertion import Elites, Inserted, candidates, sound
from .loop import Plan, Settled, State, Turn
from .qdax import QdaxEmitter

Numbers = float | int | Sequence[Any] | np.ndarray | np.generic | Array
"""A number, or an array of numbers of any kind."""


@runtime_checkable
class Space(Protocol):
    """The genotypes of a search; emitters call it for a random one."""

    def __call__(self, *, key: PRNGKeyArray) -> Genotype:
        """Draw one genotype."""
        ...

    @property
    def counters(self) -> Counters:
        """The first numbers that no gene of a random genotype has."""
        ...

    def decode(self, genotypes: Any) -> Any:
        """Return the arguments of a function: scaled vectors, or the networks themselves."""
        ...


@dataclass(frozen=True)
class Vectors:
    """Vectors with a number of genes, each from `low` to `high`, drawn uniformly.

    Bounds are numbers, or a number for each gene. Emitters vary genes from −1 to 1, so their
    steps are relative to half of the range. Raises `ValueError` for other bounds.
    """

    genes: int
    low: Numbers = -1.0
    high: Numbers = 1.0

    def __post_init__(self) -> None:
        refuse_uncountable(1, genes=self.genes)
        low, high = (self._bound(name) for name in ("low", "high"))
        if not np.all(low < high):
            raise ValueError(
                f"`low` must be below `high` in single precision, got {self.low} and "
                f"{self.high}"
            )

    def _bound(self, name: str) -> Float[np.ndarray, "*gene"]:
        """Return a bound as genotypes have it. Raise `ValueError` if it is none."""
        given = getattr(self, name)
        bound = _array(name, given)
        able = bound.dtype.kind in "iuf" and bound.shape in ((), (self.genes,))
        with np.errstate(over="ignore"):
            bound = bound.astype(np.float32) if able else bound
        if not able or not np.isfinite(bound).all():
            several = f"or {self.genes} of them, in single precision"
            raise InvalidField(name, f"must be a finite number, {several}; got {given!r}")
        return bound

    def __call__(self, *, key: PRNGKeyArray) -> Vector:
        return Vector(jax.random.uniform(key, (self.genes,), jnp.float32, -1.0, 1.0))

    @property
    def counters(self) -> Counters:
        return first_counters(1, 1)

    def decode(self, genotypes: Vector) -> Any:
        """Scale genes from ±1 to the bounds, on the host if they are NumPy arrays."""
        host = isinstance(genotypes.values, np.ndarray)
        wide = np.float64 if host else genotypes.values.dtype
        shape = genotypes.values.shape
        low, high = (np.broadcast_to(np.asarray(x, wide), shape) for x in (self.low, self.high))
        scaled = low + (high - low) * (genotypes.values.astype(wide) + 1) / 2
        if host:
            return np.clip(scaled, low, high).astype(np.float32)
        return jnp.clip(scaled, low, high)


@dataclass(frozen=True)
class Networks:
    """Networks (CPPNs) that NEAT grows from all inputs linked to all outputs.

    `nodes` and `connections` are the most that a network can have.
    """

    inputs: int
    outputs: int
    nodes: int = 32
    connections: int = 64

    def __post_init__(self) -> None:
        refuse_uncountable(1, inputs=self.inputs, outputs=self.outputs)
        refuse_uncountable(self.inputs + self.outputs, nodes=self.nodes)
        refuse_uncountable(self.inputs * self.outputs, connections=self.connections)

    def __call__(self, *, key: PRNGKeyArray) -> CPPN:
        return minimal(key, self.inputs, self.outputs, self.nodes, self.connections)

    @property
    def counters(self) -> Counters:
        return first_counters(self.inputs, self.outputs)

    def decode(self, genotypes: CPPN) -> CPPN:
        return genotypes

    def outputs_of(
        self, networks: CPPN, points: Numbers
    ) -> Float[Array, "network point output"]:
        """Return the outputs of each network of a batch at each point (point, input).

        Raises `ValueError` for points of another shape.
        """
        points = jnp.asarray(points, jnp.float32)
        if points.ndim != 2 or points.shape[1] != self.inputs:
            raise ValueError(
                f"`points` must be rows of {self.inputs} inputs, got shape {points.shape}"
            )
        return _outputs(networks, points, self.outputs)


@partial(jax.jit, static_argnums=2)
def _outputs(networks: CPPN, points: Float[Array, "point input"], count: int) -> Array:
    one = partial(evaluate, inputs=points.T, outputs=count)
    return jnp.swapaxes(eqx.filter_vmap(one)(networks), 1, 2)


Function = Callable[[Any], tuple[Any, Any]]
"""A JAX function of one decoded genotype: its fitness, and its measures as a vector."""


class Progress(eqx.Module):
    """The part of the state that compiled programs advance."""

    generation: Int[Array, ""]
    infeasible: Int[Array, ""]
    elites: Elites
    counters: Counters
    emitters: tuple[PyTree[Array], ...]


class Results(NamedTuple):
    """The results of a generation, as the loop takes them."""

    fitness: np.ndarray
    measures: np.ndarray
    status: np.ndarray
    """0 for a feasible evaluation."""


@dataclass(frozen=True)
class Fused:
    """The steps of a generation in two compiled programs; `loop.Steps`."""

    emission: Callable[..., Any]
    insertion: Callable[..., Any]

    def emit(
        self, state: State, elites: Elites
    ) -> tuple[Children, tuple[PyTree[Array], ...], Counters]:
        children, after = self.emission(progress_of(state))
        return children, after.emitters, after.counters

    def settle(self, turn: Turn, *, keep: bool) -> Settled:
        before, batch, results = turn.before, turn.batch, turn.evaluation
        number, container = turn.number, before.container
        feasible = results.status == 0
        given = batch.children, results.fitness, results.measures, feasible
        if changes(container, number):
            genotypes = batch.children.genotypes
            rows = candidates(number, genotypes, *map(jnp.asarray, given[1:]))
            container = refreshed(container, before.elites, rows, number)
        progress = replace(
            progress_of(before), counters=batch.counters, emitters=batch.emitters
        )
        after, inserted = self.insertion(container, progress, *given)
        infeasible = int(after.infeasible) - before.infeasible
        inserted = jax.device_get(inserted)
        learned = after.elites, after.emitters, after.counters
        return Settled(container, *learned, inserted, infeasible)


def progress_of(state: State) -> Progress:
    """Return the part of a state that compiled programs advance."""
    return Progress(
        generation=jnp.asarray(state.generation, jnp.int32),
        infeasible=jnp.asarray(state.infeasible, jnp.int32),
        elites=state.elites,
        counters=state.counters,
        emitters=state.emitters,
    )


def changes(container: Container, generation: int) -> bool:
    """Return whether a container may change in a generation."""
    return isinstance(container, Survival) and container.changes(generation)


class ListedElites(NamedTuple):
    """Elites, a row each, in the order of their cells; one elite has no such axis."""

    cell: np.ndarray
    fitness: np.ndarray
    measures: np.ndarray
    """Rows of all measures."""
    genotypes: Any
    """Vectors (elite, gene) within the bounds, or a batch of networks."""


class Search:
    """A search on any evaluation function, by `ask` and `tell`.

    `space` is `Vectors` or `Networks`, `container` a `Grid` or `voronoi` of `Axis` or another
    container, and emitters are those of `search.emitters`, whose slots together are the batch.
    The function gives each genotype a fitness, which is maximised, and `measures` numbers: as
    many as the axes need, or more. The same seed and outcomes give the same search.

    Raises `ValueError` without emitters, for emitters that need derivatives or do not fit the
    space or the container, and for a seed that is not a whole number from 0 to 2³² − 1.
    """

    def __init__(
        self,
        space: Space,
        container: Container,
        emitters: Sequence[Emitter],
        *,
        seed: int | np.integer = 0,
        measures: int | np.integer | None = None,
    ) -> None:
        self.space, self.emitters = space, tuple(emitters)
        needed = 1 + int(max(needed_columns(container)))
        if measures is not None:
            refuse_uncountable(needed, measures=measures)
        self.measures = needed if measures is None else int(measures)
        # JAX would take a longer seed for its last 32 bits.
        refuse_uncountable(0, 2**32 - 1, seed=seed)
        seed = int(seed)
        refuse_unfit(self.emitters, space, container)
        key = jax.random.key(seed, impl="threefry2x32")
        self._emit = jax.jit(partial(_emitted, self.emitters, key=key))
        # `_tell` overwrites the archive that it receives.
        self._tell = jax.jit(partial(_told, self.emitters), donate_argnums=1)
        self.plan = Plan(
            seed=seed,
            container=container,
            emitters=self.emitters,
            counters=space.counters,
            genotype=jax.eval_shape(space, key=key),
            measures=tuple(f"measure {number}" for number in range(self.measures)),
            steps=Fused(self._emit, self._tell),
        )
        self.batch = self.plan.batch
        self._state = loop.start(self.plan)
        self._asking: loop.Asking | None = None
        self._asked: Any = None
        self._runs = dict[Function, tuple[Callable, ...]]()

    def ask(self) -> Any:
        """Return the genotypes to evaluate, a row for each slot.

        Vectors are a NumPy array (slot, gene) within the bounds, networks a batch of `CPPN`,
        which `Networks.outputs_of` evaluates. The same rows are returned until `tell`.
        """
        if self._asking is None:
            self._begin()
        return self.space.decode(jax.device_get(self._asked))

    def _begin(self) -> None:
        """Begin a generation; one whose emission fails has not begun."""
        asking = loop.generation(self.plan, self._state)
        self._asked = next(asking).rows
        self._asking = asking

    def tell(
        self, fitness: Numbers, measures: Numbers, feasible: Numbers | None = None
    ) -> Inserted:
        """Insert the genotypes of the last `ask` and let the emitters learn.

        Takes fitness (slot), measures (slot, measure) and, if some evaluations must not count,
        feasible (slot). Rows without a finite fitness and finite descriptors are infeasible.
        Returns each slot's cell, whether it entered, and its improvement. Raises `ValueError`
        before `ask`, for arrays of another shape, and for values that are no numbers, or no
        truth values.
        """
        if self._asking is None:
            raise ValueError("`tell` must follow `ask`, got no genotypes asked for")
        rows = self.batch
        fitness = checked("fitness", fitness, np.float32, (rows,))
        measures = checked("measures", measures, np.float32, (rows, self.measures))
        feasible = np.ones(rows, bool) if feasible is None else feasible
        feasible = checked("feasible", feasible, bool, (rows,))
        return self._answer(Results(fitness, measures, np.where(feasible, 0, 1)))

    def _answer(self, results: Results) -> Inserted:
        """End the generation that was asked for."""
        # Whatever happens, the generation is over: a failed one is asked for again.
        asking, self._asking = self._asking, None
        assert asking is not None
        try:
            asking.send(results)
        except StopIteration as done:
            turn: Turn = done.value
        else:
            raise AssertionError("a search without parts asks once in a generation")
        self._state = turn.after
        return turn.settled.inserted

    def run(self, function: Function, generations: int) -> None:
        """Advance by generations of a JAX function, all in one compiled program.

        The function takes one decoded genotype and returns its fitness and its measures.
        It is faster than `ask` and `tell`, but rounds differently. How many generations a call
        takes does not matter. Each new function is compiled, so keep it between calls. A
        generation in which the container changes is by `ask` and `tell`. Raises `ValueError`
        for a function that returns anything else.
        """
        refuse_uncountable(0, generations=generations)
        if function not in self._runs:
            many = partial(self._generations, function)
            self._runs[function] = jax.jit(many), jax.jit(partial(self._evaluated, function))
        advanced, evaluated = self._runs[function]
        self._asking, end = None, self.generation + generations
        while (begun := self.generation) < end:
            numbers = range(begun, end)
            steady = next((n for n in numbers if changes(self.container, n + 1)), end) - begun
            if steady:
                self._advance(advanced(self.container, progress_of(self._state), steady))
                continue
            self._begin()
            fitness, measures = jax.device_get(evaluated(self._asked))
            self._answer(Results(fitness, measures, np.zeros(self.batch, np.int32)))

    def _advance(self, progress: Progress) -> None:
        """Take over what a compiled loop has advanced."""
        number = int(progress.generation)
        self._state = replace(
            self._state,
            generation=number,
            evaluations=number * self.batch,
            infeasible=int(progress.infeasible),
            elites=progress.elites,
            counters=progress.counters,
            emitters=progress.emitters,
        )

    def _generations(
        self, function: Function, container: Container, progress: Progress, count: Any
    ) -> Progress:
        def generation(_: Any, before: Progress) -> Progress:
            children, after = self._emit(before)
            given = *self._evaluated(function, children.genotypes), jnp.ones(self.batch, bool)
            return _told(self.emitters, container, after, children, *given)[0]

        return jax.lax.fori_loop(0, count, generation, progress)

    def _evaluated(self, function: Function, genotypes: Any) -> tuple[Array, Array]:
        found = jax.vmap(function)(self.space.decode(genotypes))
        wanted = [(self.batch,), (self.batch, self.measures)]
        arrays = list(found) if isinstance(found, tuple | list) else [found]
        able = all(isinstance(one, jax.Array) and not jnp.iscomplexobj(one) for one in arrays)
        if not able or [one.shape for one in arrays] != wanted:
            got = jax.tree.map(lambda x: f"{x.dtype}{list(x.shape[1:])}", found)
            raise ValueError(
                f"`function` must return a real fitness [] and measures [{self.measures}], "
                f"got {got}"
            )
        fitness, measures = arrays
        return fitness.astype(jnp.float32), measures.astype(jnp.float32)

    @property
    def container(self) -> Container:
        """The container, with what it has learned."""
        return self._state.container

    @property
    def generation(self) -> int:
        """Generations completed."""
        return self._state.generation

    @property
    def evaluations(self) -> int:
        return self._state.evaluations

    @property
    def infeasible(self) -> int:
        """Evaluations that could not enter."""
        return self._state.infeasible

    @property
    def coverage(self) -> float:
        """Share of the cells that have an elite."""
        return float(np.mean(np.isfinite(best_of_cells(self._state.elites, self.container))))

    @property
    def qd_score(self) -> float:
        """Sum of the best fitness of each cell; fitness should not be negative."""
        return float(np.nansum(best_of_cells(self._state.elites, self.container)))

    @property
    def elites(self) -> ListedElites:
        """The elites, in the order of their cells or places."""
        return self._listed(np.flatnonzero(self._state.elites.occupied))

    @property
    def best(self) -> ListedElites | None:
        """The fittest elite, the first of equal ones; None while there is none."""
        elites = self._state.elites
        if not np.any(elites.occupied):
            return None
        height = np.where(elites.occupied, elites.fitness, -np.inf)
        elite = self._listed(np.array([np.argmax(height)]))
        return jax.tree.map(lambda x: x[0], elite)

    def _listed(self, cells: np.ndarray) -> ListedElites:
        rows = jax.tree.map(lambda x: np.asarray(x)[cells], self._state.elites)
        decoded = self.space.decode(rows.genotypes)
        return ListedElites(cells.astype(np.int32), rows.fitness, rows.measures, decoded)

    def save(self) -> bytes:
        """Return an archive file to `restore`; an unanswered `ask` is not part of it."""
        attributes = {
            "format": file.FORMAT,
            "version": VERSION,
            "search": json.dumps(self._description()),
            "measures": json.dumps(self.plan.measures),
            "operators": json.dumps(OPERATORS),
        }
        return file.dump(state_file.to_tree(self.plan, self._state), attributes)

    def restore(self, data: bytes) -> None:
        """Continue from the file of a search with the same arguments, bit for bit.

        Raises `ValueError` for the file of another search, naming the first difference.
        """
        if not isinstance(data, bytes | bytearray | memoryview):
            raise ValueError(f"`data` must be the bytes of a file, got {data!r:.120}")
        tree, attributes = file.load(bytes(data))
        stored = json.loads(attributes["search"])
        for name, here in json.loads(json.dumps(self._description())).items():
            if _comparable(stored.get(name)) != _comparable(here):
                raise ValueError(f"`{name}` must be the file's, {stored.get(name)}, got {here}")
        self._state, self._asking = state_file.from_tree(self.plan, tree, attributes), None

    def _description(self) -> dict[str, Any]:
        unlearned, elites = self.plan.container, self._state.elites
        cells, survival = cells_of(self.container), isinstance(unlearned, Survival)
        around = np.asarray(cells.centroids).tobytes() if isinstance(cells, Voronoi) else b""
        return {
            "seed": self.plan.seed,
            "measures": self.measures,
            "container": described(unlearned) if survival else [type(cells).__name__],
            "axes": [
                {name: _plain(value) for name, value in vars(axis).items()}
                for axis in measured_axes(self.container)
            ],
            "cells": [cells.count, sha256(around).hexdigest()],
            "space": described(self.space),
            "genes": [list(x.shape[1:]) for x in jax.tree.leaves(elites.genotypes)],
            "emitters": [described(one) for one in self.emitters],
        }


OF_VECTORS, OF_NETWORKS = IsoLine | CmaMae | QdaxEmitter, Neat | PopulationNeat


def refuse_unfit(emitters: tuple[Emitter, ...], space: Space, container: Container) -> None:
    """Raise `ValueError` without emitters, or for those that `Search` cannot run."""
    if not emitters:
        raise ValueError("`emitters` must hold at least one, got none")
    for emitter in emitters:
        if isinstance(emitter, Learner):
            raise ValueError(
                f"`emitters` must do without derivatives, got {type(emitter).__name__}"
            )
        given = getattr(emitter, "newcomer", None)
        newcomer = cast(Space, given if callable(given) else space)
        if _form(newcomer) != _form(space):
            raise ValueError(
                f"`emitters` must be of the search's space, {space}; got "
                f"{type(emitter).__name__} of {newcomer}"
            )
        _refuse_other_genotypes(emitter, space)
        _refuse_other_cells(emitter, container)


def _refuse_other_genotypes(emitter: Emitter, space: Space) -> None:
    """Raise `ValueError` for an emitter that cannot vary the genotypes of a space."""
    one, name = jax.eval_shape(space, key=jax.random.key(0)), type(emitter).__name__
    for able, genotypes in ((OF_VECTORS, Vector), (OF_NETWORKS, Graph)):
        if isinstance(emitter, able) and not isinstance(one, genotypes):
            needed = "vectors" if genotypes is Vector else "networks"
            raise ValueError(
                f"`emitters` must vary genotypes of the search's space, {space}; got {name}, "
                f"which varies {needed}"
            )
    if isinstance(emitter, OF_NETWORKS) and isinstance(space, Networks):
        for end in ("inputs", "outputs"):
            needed = getattr(space, end)
            if (given := getattr(emitter, end, needed)) != needed:
                raise ValueError(
                    f"`emitters` must have the {end} of the search's space, {needed}; got "
                    f"{name} of {given}"
                )


def _refuse_other_cells(emitter: Emitter, container: Container) -> None:
    """Raise `ValueError` for an emitter that learns from cells which a container lacks."""
    if not isinstance(emitter, CmaMae | QdaxEmitter):
        return
    name = type(emitter).__name__
    if isinstance(container, Survival):
        raise ValueError(
            f"`emitters` must not learn from cells with {type(container).__name__}, which has "
            f"none; got {name}"
        )
    counted = isinstance(emitter, CmaMae)
    count = emitter.cells if counted else emitter.cells.count
    if count != container.count or not (counted or eqx.tree_equal(emitter.cells, container)):
        raise ValueError(
            f"`emitters` must learn from the {container.count} cells of the search; got {name} "
            f"of {count} others"
        )


def _form(space: Space) -> tuple[Any, ...]:
    """Return the structure of a genotype, and the shapes and types of its arrays; of networks
    their inputs and outputs, which no shape tells."""
    one = jax.eval_shape(space, key=jax.random.key(0))
    ends = (space.inputs, space.outputs) if isinstance(space, Networks) else ()
    arrays = [(leaf.shape, leaf.dtype) for leaf in jax.tree.leaves(one)]
    return jax.tree.structure(one), arrays, ends


def checked(name: str, given: Numbers, kind: Any, shape: tuple[int, ...]) -> np.ndarray:
    """Return an array of a kind. Raises `ValueError` for another shape, or other values."""
    values = _array(name, given)
    if values.shape != shape:
        raise ValueError(f"`{name}` must have shape {shape}, got {values.shape}")
    needed = "true or false" if kind is bool else "real numbers"
    if np.ma.is_masked(given):
        raise ValueError(f"`{name}` must be {needed}, got masked values")
    # JAX's own kinds, such as bfloat16, are no kinds of NumPy.
    able = values.dtype.kind in "biuf" or jnp.issubdtype(values.dtype, jnp.floating)
    if values.dtype.kind == "O" and all(map(_is_real, values.flat)):
        values, able = values.astype(float), True
    if kind is bool:  # 0 and 1 of any kind of number are truth values too.
        able = able and bool(np.isin(values, (0, 1)).all())
    if not able:
        raise ValueError(f"`{name}` must be {needed}, got {given!r:.120}")
    with np.errstate(over="ignore"):  # Beyond single precision a number is not finite.
        return values.astype(kind)


def _array(name: str, given: Any) -> np.ndarray:
    """Return an array. Raise `ValueError` for rows of several lengths."""
    try:
        return np.asarray(given)
    except ValueError as error:
        raise InvalidField(name, f"must have rows of one length, got {given!r:.120}") from error


def _is_real(value: Any) -> bool:
    """Return whether a double precision number can stand for a value; None becomes NaN."""
    if isinstance(value, int | Fraction):
        return abs(value) < 2**1023
    return value is None or isinstance(value, Real)


def described(part: Any) -> list[Any]:
    """Return the name of a part's class, and its fields that are words, numbers, arrays of any
    library, or such parts; of a class of somebody's own, its public attributes."""
    names = [one.name for one in fields(part)] if is_dataclass(part) else _public(part)
    return [type(part).__name__, *(_plain(getattr(part, name)) for name in names)]


def _public(part: Any) -> list[str]:
    return sorted(name for name in getattr(part, "__dict__", {}) if name[0] != "_")


def _comparable(value: Any) -> str:
    """Return a text that is the same for equal numbers, 1 and 1.0 or two NaN."""
    return json.dumps(json.loads(json.dumps(value), parse_int=float))


def _plain(value: Any) -> Any:
    if is_dataclass(value):
        return described(value)
    if isinstance(value, tuple | list):
        return [_plain(one) for one in value]
    if isinstance(value, bool | int | float | str | np.ndarray | np.generic | jax.Array):
        return np.asarray(value).tolist()
    return None  # A function, which no file describes.


def _emitted(
    emitters: tuple[Emitter, ...], before: Progress, *, key: Array
) -> tuple[Children, Progress]:
    children, states, counters = emit(
        emitters, before.emitters, before.elites, before.counters, before.generation, key=key
    )
    return children, replace(before, emitters=states, counters=counters)


def _told(
    emitters: tuple[Emitter, ...],
    container: Container,
    before: Progress,
    children: Children,
    fitness: Array,
    measures: Array,
    feasible: Array,
) -> tuple[Progress, Inserted]:
    number = before.generation + 1
    rows = candidates(number, children.genotypes, fitness, measures, feasible)
    feasible = sound(rows, measured_axes(container))
    rows = replace(rows, occupied=feasible)
    elites, inserted = insert(before.elites, rows, container)
    after = Progress(
        generation=number,
        infeasible=before.infeasible + jnp.sum(~feasible, dtype=jnp.int32),
        elites=replace(elites, curiosity=credit(elites, children.parents[:, 0], inserted)),
        counters=before.counters,
        emitters=tell(emitters, before.emitters, outcome(rows, inserted)),
    )
    return after, inserted
