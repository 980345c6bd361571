"""Learned axes of an archive file: the measures they are made of, and the elites on them."""

import json
from dataclasses import dataclass

import numpy as np

from ..invalid import InvalidField
from . import measured
from .axes import floors
from .components import Components, scaled
from .export import Source, source_bytes
from .file import load

PARTS = ("mean", "scale", "weights", "explained", "low", "high")


@dataclass(frozen=True)
class LearnedAxes:
    """The axes that a search has learned last, and its elites along them."""

    measures: tuple[str, ...]
    """Measures of which axes are made."""
    components: Components
    coordinates: np.ndarray
    """Elites (elite, axis) in the order of their places, as in `archive/*` of the file."""
    creature: np.ndarray
    """The SHA-256 of each elite."""
    generation: np.ndarray
    """Generations in which axes were learned."""

    @property
    def loadings(self) -> np.ndarray:
        """Return the weights (axis, measure); squares add up to 1 on an axis."""
        return self.components.weights

    @property
    def explained(self) -> np.ndarray:
        """Return the share of the variance of all measures along each axis."""
        return self.components.explained

    @property
    def ends(self) -> np.ndarray:
        """Return the ends (axis, 2), the lower one first."""
        return np.stack([self.components.low, self.components.high], 1)

    def places(self, measures: np.ndarray) -> np.ndarray:
        """Return coordinates (creature, axis) of other creatures, from values (creature,
        measure) of `measures`."""
        return self.components.coordinates(scaled(measures, floors(self.measures)))

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
        raise InvalidField("archive.container.kind", f"must be 'learned', got {kind!r}")
    known = tree["loop"]["container"]
    if not known["epoch"]:
        raise ValueError("axes must have been learned, got a file from before: go on with it")
    recorded = measured.columns(tree, attributes)
    names = container["measures"] or list(recorded)
    found = Components(**{name: np.asarray(known[name], float) for name in PARTS})
    columns = np.stack([recorded[name] for name in names], 1)
    values = scaled(columns, floors(names))
    return LearnedAxes(
        measures=tuple(names),
        components=found,
        coordinates=found.coordinates(values),
        creature=tree["archive"]["creature"],
        generation=tree["learned"]["generation"],
    )
