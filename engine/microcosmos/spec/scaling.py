"""The spec of a measurement of wall time against the number of nodes, and its presets."""

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from ..invalid import InvalidField
from .base import PAPER, Part, field, refuse
from .world import Steric

Nodes = Annotated[int, Field(ge=20, le=2_000_000, json_schema_extra={"unit": "nodes"})]

NODES = (1_000, 2_000, 4_000, 8_000, 16_000, 32_000, 64_000, 128_000, 256_000, 500_000)
SPACING = 0.35
"""Cells between nodes, along a filament and across: 500,000 nodes fill a box of 256²."""


class Scaling(Part):
    """Wall time of the paper's 1,000 steps, and of each part, against the number of nodes."""

    experiment: Literal["scaling"] = "scaling"
    nodes: Annotated[tuple[Nodes, ...], Field(min_length=2, max_length=64)] = NODES
    """Numbers of nodes, ascending; filaments lie at random places side by side."""
    filament: int = field(20, ge=3, le=1000, unit="nodes")
    """Nodes per filament."""
    width: int = field(256, ge=32, le=2048, unit="cells", source=PAPER)
    """Width of the box (x)."""
    height: int = field(256, ge=32, le=2048, unit="cells", source=PAPER)
    """Height of the box (y)."""
    steps: int = field(1000, ge=2, le=1_000_000, unit="steps", source=PAPER)
    """Measured steps; times are reported per 1,000."""
    part_steps: int = field(20, ge=2, le=10_000, unit="steps")
    """With JAX: measured steps of each part, repeated three times."""
    steric: Steric = Steric()
    """Repulsion between nodes."""
    all_pairs: int = field(8_000, ge=0, le=100_000, unit="nodes")
    """Largest number of nodes for which all-pairs repulsion is timed too; 0: never."""
    seed: int = field(0, ge=0, lt=2**32)
    """Random seed of the filaments' places."""

    @model_validator(mode="after")
    def check(self) -> Self:
        refuse(
            list(self.nodes) != sorted(set(self.nodes)),
            "nodes",
            f"must ascend, got {list(self.nodes)}",
        )
        if odd := [n for n in self.nodes if n % self.filament]:
            raise InvalidField(
                "nodes", f"must be multiples of `filament` ({self.filament}), got {odd}"
            )
        columns, rows = self.places
        refuse(
            max(self.nodes) > columns * rows * self.filament,
            "nodes",
            f"must be at most {columns * rows * self.filament} in a box of "
            f"{self.width} × {self.height}, got {max(self.nodes)}",
        )
        return self

    @property
    def places(self) -> tuple[int, int]:
        """Return the filaments that fit along x, and along y."""
        return int(self.width / (self.filament * SPACING)), int(self.height / SPACING)

    def centres(self, nodes: int) -> np.ndarray:
        """Return the centres (filament, 2) in cells of filaments with `nodes` nodes in all."""
        columns, rows = self.places
        place = np.random.default_rng(self.seed).permutation(columns * rows)
        place = place[: nodes // self.filament]
        numbers = np.stack([place % columns + 0.5, place // columns + 0.5], 1)
        return numbers * (self.filament * SPACING, SPACING)

    @property
    def generations(self) -> int:
        """Return the number of measurements, one for each number of nodes."""
        return len(self.nodes)


PRESETS = {
    "demo": (
        "Up to 16,000 nodes in 128 × 128 cells, a minute on a laptop",
        Scaling(
            nodes=NODES[:5], width=128, height=128, steps=40, part_steps=5, all_pairs=4_000
        ),
    ),
    "paper": (
        "The paper's figure: 256 × 256 cells, up to 500,000 nodes, 1,000 steps",
        Scaling(),
    ),
}
