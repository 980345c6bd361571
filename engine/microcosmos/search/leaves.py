"""Arrays of a tree by their paths, as files hold them."""

from typing import Any, TypeVar

import jax
import jax.numpy as jnp
import numpy as np

Tree = TypeVar("Tree")


def leaves(tree: Any) -> dict[str, np.ndarray]:
    """Return the arrays of a tree by their paths."""
    found = jax.tree_util.tree_leaves_with_path(tree)
    return {_path_of(path): np.asarray(leaf) for path, leaf in found}


def filled(tree: Tree, arrays: dict[str, Any]) -> Tree:
    """Return a tree of the same structure with the arrays of `leaves`."""
    return jax.tree_util.tree_map_with_path(
        lambda path, old: jnp.asarray(arrays[_path_of(path)], old.dtype), tree
    )


def _path_of(path: tuple) -> str:
    return jax.tree_util.keystr(path, simple=True, separator=".")
