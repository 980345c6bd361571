"""Learned axes of an archive file: the measures they are made of, and the elites on them."""

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float, Int, UInt8

from .components import Components, floors, scaled
from .export import Source, source_bytes
from .file import Tree, load

PARTS = ("mean", "scale", "weights", "explained", "low", "high")


@dataclass(frozen=True)
class LearnedAxes:
    """The axes that a search has learned last, and its elites along them."""

    measures: tuple[str, ...]
    """Measures of which axes are made."""
    components: Components
    coordinates: Float[np.ndarray, "elite axis"]
    """Elites in the order of their places, as in `archive/*` of the file."""
    creature: UInt8[np.ndarray, "elite 32"]
    """The SHA-256 of each elite."""
    generation: Int[np.ndarray, "epoch"]
    """Generations in which axes were learned."""

    @property
    def loadings(self) -> Float[np.ndarray, "axis measure"]:
        """Return the weight of each measure on each axis; squares add up to 1 on an axis."""
        return self.components.weights

    @property
    def explained(self) -> Float[np.ndarray, "axis"]:
        """Return the share of the variance of all measures along each axis."""
        return self.components.explained

    @property
    def ends(self) -> Float[np.ndarray, "axis 2"]:
        """Return the lower and upper end of each axis."""
        return np.stack([self.components.low, self.components.high], 1)

    def strongest(self, axis: int, count: int = 8) -> list[tuple[str, float]]:
        """Return the measures of the largest weights on an axis, the largest first."""
        weights = self.components.weights[axis]
        order = np.argsort(-np.abs(weights), kind="stable")[:count]
        return [(self.measures[i], float(weights[i])) for i in order.tolist()]


def learned_axes(archive: Source) -> LearnedAxes:
    """Return the learned axes of an archive file, or of its path.

    Raises `ValueError` for a file of a search without learned axes, or without any yet.
    """
    tree, attributes = load(source_bytes(archive))
    container = json.loads(attributes["spec"]).get("archive", {}).get("container") or {}
    if container.get("kind") != "learned":
        kind = container.get("kind", "none")
        raise ValueError(f"`archive.container.kind` must be 'learned', got {kind!r}")
    known = tree["loop"]["container"]
    if not known["epoch"]:
        raise ValueError("axes must have been learned, got a file from before: go on with it")
    recorded = json.loads(attributes["measures"])
    names = container["measures"] or recorded
    found = Components(**{name: np.asarray(known[name], float) for name in PARTS})
    values = _values(tree, [recorded.index(name) for name in names], names)
    return LearnedAxes(
        measures=tuple(names),
        components=found,
        coordinates=found.coordinates(values),
        creature=tree["archive"]["creature"],
        generation=tree["learned"]["generation"],
    )


def _values(tree: Tree, columns: list[int], names: list[str]) -> Any:
    return scaled(tree["archive"]["measures"][:, columns], floors(names))
