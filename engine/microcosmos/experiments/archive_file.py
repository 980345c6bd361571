"""The archive file of a quality-diversity run, which is also its checkpoint.

The layout is described in `docs/formats.md`. It holds no clock, host, run or attempt: the
same run gives the same bytes, however often it was interrupted.
"""

import json
from dataclasses import replace
from typing import Any, TypeVar

import equinox as eqx
import jax
import numpy as np

from .. import neat, search
from ..archive import file, poses
from ..device import array
from ..genomes import columns, from_columns
from ..search.leaves import filled, leaves
from ..version import VERSION
from . import fronts
from .epochs import Epochs
from .named import Choices, InitialCreatures
from .resume_check import devices_of
from .state import (
    CURVES,
    ENDS,
    OUTCOMES,
    PREDICTIONS,
    Infeasible,
    Lineage,
    Plan,
    Screened,
    State,
    prolonged,
    start,
)

Module = TypeVar("Module", bound=eqx.Module)

ROWS = ("fitness", "measures", "generation", "slot", "curiosity")
"""Columns of elites that are written unchanged."""


def save(plan: Plan, state: State) -> bytes:
    """Return the file of a state; only occupied cells are written."""
    state = jax.device_get(state)
    cells = np.flatnonzero(state.elites.occupied)
    elites = jax.tree.map(lambda x: x[cells], state.elites)
    loop = _loop(plan, state, cells)
    tree = {
        "archive": {
            "cell": cells.astype(np.int32),
            "descriptors": elites.measures[:, [axis.measure for axis in plan.axes]],
            "creature": state.creatures[cells],
            "operator": state.operators[cells],
            "device": state.device_of[cells],
            "genomes": columns(elites.genotypes),
            "repeats": vars(jax.tree.map(lambda x: x[cells], state.repeats)),
            "poses": poses.columns([state.poses[cell] for cell in cells.tolist()]),
            **{name: getattr(elites, name) for name in ROWS},
        },
        "curves": {name: state.curves[:, i] for i, name in enumerate(CURVES)},
        "emitters": {name: state.outcomes[:, :, i] for i, name in enumerate(OUTCOMES)},
        "lineage": vars(state.lineage),
        "infeasible": vars(state.failures) | {"genotypes": columns(state.failures.genotypes)},
        "loop": loop,
        **fronts.columns(state),
    }
    if state.screened is not None:
        pairs = zip(PREDICTIONS, state.screened.predictions.T, strict=True)
        tree["screening"] = dict(pairs)
    if state.first is not None:
        tree["archive"]["first"] = state.first.of(cells)
    _hold_container(tree, state)
    if state.initial is not None:
        genes = columns(state.initial.genotypes)
        tree["initial"] = {"creature": state.initial.creature, "genomes": genes}
    if len(state.choices.generation):
        genes = columns(state.choices.genotypes)
        tree["choices"] = vars(state.choices) | {"genotypes": genes}
    return file.dump(tree, _attributes(plan, state))


def _loop(plan: Plan, state: State, cells: np.ndarray) -> dict[str, Any]:
    """Return what only the next generation needs."""
    loop = {
        "generation": np.int64(state.generation),
        "evaluations": np.int64(state.evaluations),
        "infeasible": np.int64(state.infeasible),
        "ended": np.int64(state.ended),
        "counters": vars(state.counters),
        "nearest_ancestors": state.nearest_ancestors,
        "emitters": leaves(state.emitters),
    }
    if np.isfinite(plan.limits.device_hours):  # Without the limit it only changes bytes.
        loop["device_seconds"] = np.float64(state.device_seconds)
    if state.unrepeated is not None:
        loop["unrepeated"] = vars(jax.tree.map(lambda x: x[cells], state.unrepeated))
    if state.screened is not None:
        loop["model"] = vars(state.screened.model)
    return loop


def restore(plan: Plan, data: bytes, *, other_device: bool) -> State:
    """Return the state that `save` wrote; see `Evolution.restore` for what it raises."""
    tree, attributes = file.load(data)
    devices = devices_of(plan.spec, plan.device, attributes, other_device)
    state, archive, loop = start(plan), tree["archive"], tree["loop"]
    cells, initial, infeasible = archive["cell"], tree.get("initial"), tree["infeasible"]
    genotypes = from_columns(state.elites.genotypes, archive["genomes"])
    archive.update(occupied=np.ones(len(cells), bool), genotypes=genotypes)
    state.creatures[cells] = archive["creature"]
    state.operators[cells] = archive["operator"]
    state.device_of[cells] = archive["device"]
    repeats = _placed(state.repeats, cells, archive["repeats"])
    before = "unrepeated" in loop and _placed(state.repeats, cells, loop["unrepeated"])
    restored = replace(
        state,
        generation=int(loop["generation"]),
        evaluations=int(loop["evaluations"]),
        infeasible=int(loop["infeasible"]),
        elites=_placed(state.elites, cells, archive),
        counters=neat.Counters(**{n: array(c) for n, c in loop["counters"].items()}),
        emitters=filled(state.emitters, loop["emitters"]),
        nearest_ancestors=loop["nearest_ancestors"],
        repeats=repeats,
        curves=np.stack([tree["curves"][name] for name in CURVES], 1),
        outcomes=np.stack([tree["emitters"][name] for name in OUTCOMES], 2),
        ended=int(loop["ended"]),
        device_seconds=float(loop.get("device_seconds", 0.0)),
        lineage=Lineage(**tree["lineage"]),
        failures=Infeasible(
            **infeasible
            | {"genotypes": from_columns(state.elites.genotypes, infeasible["genotypes"])}
        ),
        devices=devices,
        unrepeated=before or None,
        fronts=fronts.from_columns(tree),
        poses=dict(zip(cells.tolist(), poses.streams(tree, attributes), strict=True)),
        initial=initial
        and InitialCreatures(
            initial["creature"], from_columns(state.elites.genotypes, initial["genomes"])
        ),
    )
    if "model" in loop:
        predictions = np.stack([tree["screening"][name] for name in PREDICTIONS], 1)
        columns_of = {name: np.asarray(x) for name, x in loop["model"].items()}
        model = search.screening.Model(**columns_of)
        restored = replace(restored, screened=Screened(model, predictions))
    if restored.first is not None:
        restored = replace(restored, first=restored.first.replaced(cells, archive["first"]))
    restored = _with_container(_with_choices(restored, tree), tree)
    return prolonged(restored) if restored.generation < plan.generations else restored


def _with_choices(state: State, tree: file.Tree) -> State:
    if "choices" not in tree:
        return state
    columns_of = tree["choices"]
    genes = from_columns(state.elites.genotypes, columns_of["genotypes"])
    return replace(state, choices=Choices(**columns_of | {"genotypes": genes}))


def _hold_container(tree: dict[str, Any], state: State) -> None:
    """Add the container's centroids, and what it has learned."""
    container, around = state.container, search.cells_of(state.container)
    if isinstance(around, search.Voronoi):
        tree["archive"]["centroids"] = around.centroids
    if isinstance(container, search.Survival) and (learned := container.arrays()):
        tree["loop"]["container"] = learned
    if state.epochs is not None:
        tree["learned"] = vars(state.epochs)


def _with_container(state: State, tree: file.Tree) -> State:
    """Return the state with the file's centroids, and what its container has learned."""
    container, archive, loop = state.container, tree["archive"], tree["loop"]
    if "centroids" in archive:  # Another machine may have found slightly other ones.
        found = search.voronoi(container.axes, archive["centroids"])
        container = search.with_cells(container, found)
    if isinstance(container, search.Survival) and "container" in loop:
        container = container.with_arrays(loop["container"])
    epochs = Epochs(**tree["learned"]) if "learned" in tree else state.epochs
    return replace(state, container=container, epochs=epochs)


def _attributes(plan: Plan, state: State) -> dict[str, str]:
    end = None
    if state.ended or state.generation >= plan.generations:
        end = {"reason": ENDS[state.ended] or "generations", "generation": state.generation}
    return {
        "format": file.FORMAT,
        "version": VERSION,
        "device": json.dumps(state.devices),
        "spec": plan.spec,
        "measures": json.dumps(plan.measures),
        "force_free": json.dumps(plan.force_free),
        "operators": json.dumps(search.OPERATORS),
        "statuses": json.dumps(search.STATUSES),
        "ended": json.dumps(end),
    }


def _placed(module: Module, cells: np.ndarray, columns: dict[str, Any]) -> Module:
    """Return the module with the rows of some cells replaced.

    NumPy places them: JAX would compile again for each number of cells.
    """

    def placed(before: Any, rows: Any) -> Any:
        if isinstance(rows, eqx.Module):
            return jax.tree.map(placed, before, rows)
        if isinstance(before, eqx.Module):
            return _placed(before, cells, rows)
        after = np.array(before)
        after[cells] = rows
        return array(after)

    return replace(module, **{n: placed(x, columns[n]) for n, x in vars(module).items()})
