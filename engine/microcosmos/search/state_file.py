"""The state of a search as the arrays of a file; only occupied cells are written.

The core of the state has its place here; each part declares the places of its own (`Leaf`).
The layout is described in `docs/formats.md`.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from ..archive.file import Tree
from ..device import array
from ..genomes import Genotype, columns, from_columns
from ..neat import Counters
from .cells import Voronoi, voronoi
from .containers import Container, Survival, cells_of, with_cells
from .loop import Leaf, Part, Plan, State, like, prolonged

ROWS = ("fitness", "measures", "generation", "slot", "curiosity")
"""Columns of elites that are written unchanged."""

COUNTS = ("generation", "evaluations", "infeasible", "ended")

GROWING = ("generation", "entry")
"""Axes of leaves whose rows are only ever appended."""

Trees = TypeVar("Trees")


def to_tree(plan: Plan, state: State) -> dict[str, Any]:
    """Return the groups of the file of a state."""
    elites = jax.device_get(state.elites)
    cells = np.flatnonzero(elites.occupied)
    kept = jax.tree.map(lambda x: x[cells], elites)
    tree: dict[str, Any] = {
        "archive": {
            "cell": cells.astype(np.int32),
            "descriptors": kept.measures[:, [axis.measure for axis in plan.axes]],
            "genomes": columns(kept.genotypes),
            **{name: getattr(kept, name) for name in ROWS},
        },
        "loop": {
            **{name: np.int64(getattr(state, name)) for name in COUNTS},
            "counters": vars(jax.device_get(state.counters)),
            "emitters": leaves(jax.device_get(state.emitters)),
        },
    }
    if np.isfinite(plan.limits.device_hours):  # Without the limit it only changes bytes.
        tree["loop"]["device_seconds"] = np.float64(state.device_seconds)
    _hold_container(tree, state.container)
    for part in plan.parts:
        for name, leaf in part.leaves.items():
            value = getattr(state.parts[part.name], name)
            if not (leaf.optional and _is_empty(value)):
                _put(tree, leaf.path, _written(leaf, value, cells))
    return tree


def growing(plan: Plan) -> tuple[str, ...]:
    """Return the groups of the file whose rows are only ever appended."""
    kept = [leaf for part in plan.parts for leaf in part.leaves.values()]
    return tuple(sorted({leaf.path for leaf in kept if leaf.axis in GROWING}))


def from_tree(
    plan: Plan, tree: Tree, attributes: Mapping[str, str], devices: tuple[str, ...] = ()
) -> State:
    """Return the state in a file; an ended one goes on if the plan has more generations.

    Raise `ValueError` for a group that is missing.
    """
    state, archive, loop = like(plan, devices), tree["archive"], tree["loop"]
    cells = archive["cell"]
    genotypes = from_columns(state.elites.genotypes, archive["genomes"])
    elites = {name: archive[name] for name in ROWS}
    elites |= {"occupied": np.ones(len(cells), bool), "genotypes": genotypes}
    restored = replace(
        state,
        **{name: int(loop[name]) for name in COUNTS},
        device_seconds=float(loop.get("device_seconds", 0.0)),
        container=_container(state.container, tree),
        elites=_placed(state.elites, elites, cells),
        counters=Counters(**{n: array(column) for n, column in loop["counters"].items()}),
        emitters=filled(state.emitters, loop["emitters"]),
        parts={
            part.name: _restored(part, state.parts[part.name], tree, attributes, cells)
            for part in plan.parts
        },
    )
    return prolonged(plan, restored) if restored.generation < plan.generations else restored


def _restored(
    part: Part, form: Any, tree: Tree, attributes: Mapping[str, str], cells: np.ndarray
) -> Any:
    """Return the state of a part from its leaves in the file."""
    found: dict[str, Any] = {}
    for name, leaf in part.leaves.items():
        value = getattr(form, name)
        stored = _get(tree, leaf.path, missing=leaf.optional)
        if stored is None:  # A template of a single value stands for none.
            found[name] = value if leaf.axis == "row" else None
        elif leaf.read is not None:
            found[name] = leaf.read(tree, attributes, cells)
        elif leaf.axis == "cell":
            found[name] = _placed(value, stored, cells)
        else:
            found[name] = _as(value, stored)
    return replace(form, **found) if found else form


def _written(leaf: Leaf, value: Any, cells: np.ndarray) -> Any:
    if leaf.write is not None:
        return leaf.write(value, cells)
    value = jax.device_get(value)
    if leaf.axis == "cell":
        value = jax.tree.map(lambda x: x[cells], value)
    return _columns(value)


def _columns(value: Any) -> Any:
    """Return arrays by name, of genotypes as files hold them."""
    if isinstance(value, Genotype):
        return columns(value)
    if isinstance(value, eqx.Module):
        return {name: _columns(x) for name, x in vars(value).items()}
    return value


def _as(form: Any, stored: Any) -> Any:
    """Return stored arrays as a value of the same kind as `form`, on the host."""
    if isinstance(form, Genotype):
        return from_columns(form, stored)
    if isinstance(form, eqx.Module):
        return replace(form, **{n: _as(x, stored[n]) for n, x in vars(form).items()})
    return np.asarray(stored)


def _placed(form: Any, rows: Any, cells: np.ndarray) -> Any:
    """Return a value whose rows of some cells are replaced.

    NumPy places them: JAX would compile again for each number of cells.
    """
    if isinstance(form, Genotype):
        return jax.tree.map(lambda x, new: _placed(x, new, cells), form, rows)
    if isinstance(form, eqx.Module):
        return replace(form, **{n: _placed(x, rows[n], cells) for n, x in vars(form).items()})
    after = np.array(form)
    after[cells] = rows
    return array(after) if isinstance(form, jax.Array) else after


def _is_empty(value: Any) -> bool:
    return value is None or not len(jax.tree.leaves(value)[0])


def _put(tree: dict[str, Any], path: str, value: Any) -> None:
    *groups, name = path.split("/")
    for group in groups:
        tree = tree.setdefault(group, {})
    if isinstance(value, Mapping) and isinstance(tree.get(name), dict):
        tree[name] |= value  # Several parts have columns in one group.
    else:
        tree[name] = dict(value) if isinstance(value, Mapping) else value


def _get(tree: Tree, path: str, *, missing: bool) -> Any:
    found: Any = tree
    for name in path.split("/"):
        if missing and name not in found:
            return None
        found = found[name]
    return found


def _hold_container(tree: dict[str, Any], container: Container) -> None:
    """Add the container's centroids, and what it has learned."""
    around = cells_of(container)
    if isinstance(around, Voronoi):
        tree["archive"]["centroids"] = around.centroids
    if isinstance(container, Survival) and (learned := container.arrays()):
        tree["loop"]["container"] = learned


def _container(container: Container, tree: Tree) -> Container:
    """Return the container with the file's centroids, and what it has learned."""
    archive, loop = tree["archive"], tree["loop"]
    if "centroids" in archive:  # Another machine may have found slightly other ones.
        container = with_cells(container, voronoi(container.axes, archive["centroids"]))
    if isinstance(container, Survival) and "container" in loop:
        container = container.with_arrays(loop["container"])
    return container


def leaves(tree: Any) -> dict[str, np.ndarray]:
    """Return the arrays of a tree by their paths."""
    found = jax.tree_util.tree_leaves_with_path(tree)
    return {_path_of(path): np.asarray(leaf) for path, leaf in found}


def filled(tree: Trees, arrays: Mapping[str, Any]) -> Trees:
    """Return a tree of the same structure with the arrays of `leaves`."""
    return jax.tree_util.tree_map_with_path(
        lambda path, old: jnp.asarray(arrays[_path_of(path)], old.dtype), tree
    )


def _path_of(path: tuple) -> str:
    return jax.tree_util.keystr(path, simple=True, separator=".")
