"""A search of your own: ask for genotypes, tell their fitness and measures.

It is the loop of `experiments.evolution` without simulations: with emitters that draw parents
from the archive it is MAP-Elites (Mouret and Clune, arXiv:1504.04909, 2015).
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from hashlib import sha256
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Int, PyTree

from ..archive import file
from ..neat import Counters
from .cells import Voronoi
from .checks import checked, described, refuse_unfit
from .containers import (
    Container,
    Survival,
    best_of_cells,
    cells_of,
    insert,
    measured_axes,
    refreshed,
)
from .emitters import Children, Emitter, begin, credit, emit, outcome, tell
from .insertion import Elites, Inserted, candidates, no_elites, sound
from .leaves import filled, leaves
from .spaces import Numbers, Space

FORMAT = "microcosmos-search/1"

Function = Callable[[Any], tuple[Any, Any]]
"""A JAX function of one decoded genotype: its fitness, and its measures as a vector."""


class Progress(eqx.Module):
    """What the next generation depends on."""

    generation: Int[Array, ""]
    infeasible: Int[Array, ""]
    elites: Elites
    counters: Counters
    emitters: tuple[PyTree[Array], ...]


class Found(NamedTuple):
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

    Raises `ValueError` without emitters, or for emitters that need derivatives or another
    library's loop.
    """

    def __init__(
        self,
        space: Space,
        container: Container,
        emitters: Sequence[Emitter],
        *,
        seed: int = 0,
        measures: int | None = None,
    ) -> None:
        self.space, self.container, self.emitters = space, container, tuple(emitters)
        needed = 1 + max(axis.measure for axis in measured_axes(container))
        self.seed, self.measures = seed, needed if measures is None else measures
        if self.measures < needed:
            raise ValueError(f"`measures` must be at least {needed}, got {self.measures}")
        refuse_unfit(self.emitters)
        self.batch = sum(emitter.slots for emitter in self.emitters)
        key = jax.random.key(seed, impl="threefry2x32")
        self._progress = Progress(
            generation=jnp.zeros((), jnp.int32),
            infeasible=jnp.zeros((), jnp.int32),
            elites=no_elites(container.count, self.measures, jax.eval_shape(space, key=key)),
            counters=space.counters,
            emitters=begin(self.emitters, key=key),
        )
        self._children: Children | None = None
        self._emit = jax.jit(partial(_emitted, self.emitters, key=key))
        self._tell = jax.jit(partial(_told, self.emitters), donate_argnums=1)
        self._unlearned, self._runs = container, dict[Function, tuple[Callable, ...]]()

    def ask(self) -> Any:
        """Return the genotypes to evaluate, a row for each slot.

        Vectors are a NumPy array (slot, gene) within the bounds, networks a batch of `CPPN`,
        which `Networks.outputs_of` evaluates. The same rows are returned until `tell`.
        """
        children = self._children
        if children is None:
            children, self._after = self._emit(self._progress)
            self._children = children
        return self.space.decode(jax.device_get(children.genotypes))

    def tell(
        self, fitness: Numbers, measures: Numbers, feasible: Numbers | None = None
    ) -> Inserted:
        """Insert the genotypes of the last `ask` and let the emitters learn.

        Takes fitness (slot), measures (slot, measure) and, if some evaluations must not count,
        feasible (slot). Rows without a finite fitness and finite descriptors are infeasible.
        Returns each slot's cell, whether it entered, and its improvement. Raises `ValueError`
        before `ask`, or for arrays of another shape.
        """
        if self._children is None:
            raise ValueError("`tell` must follow `ask`, got no genotypes asked for")
        rows = self.batch
        fitness = checked("fitness", fitness, np.float32, (rows,))
        measures = checked("measures", measures, np.float32, (rows, self.measures))
        feasible = np.ones(rows, bool) if feasible is None else feasible
        feasible = checked("feasible", feasible, bool, (rows,))
        given = self._children, fitness, measures, feasible
        self._refresh(*given)
        self._progress, inserted = self._tell(self.container, self._after, *given)
        self._children = None
        return jax.device_get(inserted)

    def run(self, function: Function, generations: int) -> None:
        """Advance by generations of a JAX function, all in one compiled program.

        The function takes one decoded genotype and returns its fitness and its measures.
        It is faster than `ask` and `tell`, but rounds differently. How many generations a call
        takes does not matter. Each new function is compiled, so keep it between calls. A
        generation in which the container changes is by `ask` and `tell`.
        """
        if function not in self._runs:
            loop = partial(self._generations, function)
            self._runs[function] = jax.jit(loop), jax.jit(partial(self._evaluated, function))
        advanced, evaluated = self._runs[function]
        self._children, end = None, self.generation + generations
        while (begun := self.generation) < end:
            numbers = range(begun, end)
            steady = next((n for n in numbers if self._changes(n + 1)), end) - begun
            if steady:
                self._progress = advanced(self.container, self._progress, steady)
                continue
            self.ask()
            assert self._children is not None
            self.tell(*evaluated(self._children))

    def _generations(
        self, function: Function, container: Container, progress: Progress, count: Any
    ) -> Progress:
        def generation(_: Any, before: Progress) -> Progress:
            children, after = self._emit(before)
            given = *self._evaluated(function, children), jnp.ones(self.batch, bool)
            return _told(self.emitters, container, after, children, *given)[0]

        return jax.lax.fori_loop(0, count, generation, progress)

    def _evaluated(self, function: Function, children: Children) -> tuple[Array, Array]:
        fitness, measures = jax.vmap(function)(self.space.decode(children.genotypes))
        return fitness.astype(jnp.float32), measures.astype(jnp.float32)

    def _changes(self, generation: int) -> bool:
        """Return whether the container may change in a generation."""
        return isinstance(self.container, Survival) and self.container.changes(generation)

    def _refresh(self, children: Children, *given: np.ndarray) -> None:
        """Let the container learn before the insertion of a generation, if it is time."""
        number = self.generation + 1
        if self._changes(number):
            rows = candidates(number, children.genotypes, *map(jnp.asarray, given))
            self.container = refreshed(self.container, self._after.elites, rows, number)

    @property
    def generation(self) -> int:
        """Generations completed."""
        return int(self._progress.generation)

    @property
    def evaluations(self) -> int:
        return self.generation * self.batch

    @property
    def infeasible(self) -> int:
        """Evaluations that could not enter."""
        return int(self._progress.infeasible)

    @property
    def coverage(self) -> float:
        """Share of the cells that have an elite."""
        return float(np.mean(np.isfinite(best_of_cells(self._progress.elites, self.container))))

    @property
    def qd_score(self) -> float:
        """Sum of the best fitness of each cell; fitness should not be negative."""
        return float(np.nansum(best_of_cells(self._progress.elites, self.container)))

    @property
    def elites(self) -> Found:
        """The elites, in the order of their cells or places."""
        return self._found(np.flatnonzero(self._progress.elites.occupied))

    @property
    def best(self) -> Found | None:
        """The fittest elite, the first of equal ones; None while there is none."""
        elites = self._progress.elites
        if not np.any(elites.occupied):
            return None
        height = np.where(elites.occupied, elites.fitness, -np.inf)
        found = self._found(np.array([np.argmax(height)]))
        return jax.tree.map(lambda x: x[0], found)

    def _found(self, cells: np.ndarray) -> Found:
        rows = jax.tree.map(lambda x: np.asarray(x)[cells], self._progress.elites)
        decoded = self.space.decode(rows.genotypes)
        return Found(cells.astype(np.int32), rows.fitness, rows.measures, decoded)

    def save(self) -> bytes:
        """Return a file from which `restore` continues, without an unanswered `ask`."""
        attributes = {"format": FORMAT, "search": json.dumps(self._description())}
        learned = self.container.arrays() if isinstance(self.container, Survival) else {}
        held = {"container": learned} if learned else {}
        return file.dump(leaves(self._progress) | held, attributes)

    def restore(self, data: bytes) -> None:
        """Continue from the file of a search with the same arguments, bit for bit.

        Raises `ValueError` for the file of another search, naming the first difference.
        """
        tree, attributes = file.load(data, FORMAT)
        there = json.loads(attributes["search"])
        for name, here in json.loads(json.dumps(self._description())).items():
            if there.get(name) != here:
                raise ValueError(f"`{name}` must be the file's, {there.get(name)}, got {here}")
        self._progress, self._children = filled(self._progress, tree), None
        if isinstance(self._unlearned, Survival) and "container" in tree:
            self.container = self._unlearned.with_arrays(tree["container"])

    def _description(self) -> dict[str, Any]:
        elites, cells = self._progress.elites, cells_of(self.container)
        survival = isinstance(self._unlearned, Survival)
        around = np.asarray(cells.centroids).tobytes() if isinstance(cells, Voronoi) else b""
        return {
            "seed": self.seed,
            "measures": self.measures,
            "container": described(self._unlearned) if survival else [type(cells).__name__],
            "axes": [vars(axis) for axis in measured_axes(self.container)],
            "cells": [cells.count, sha256(around).hexdigest()],
            "space": described(self.space),
            "genes": [list(x.shape[1:]) for x in jax.tree.leaves(elites.genotypes)],
            "emitters": [described(one) for one in self.emitters],
        }


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
    feasible = sound(rows, container.axes)
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
