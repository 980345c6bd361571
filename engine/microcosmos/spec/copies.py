"""Schools: several copies of a creature in one box."""

from math import ceil, sqrt
from typing import Literal

import numpy as np

from .base import Part, field, sourced
from .sources import OURS


class Copies(Part):
    """Copies of the creature, which beat in step in one fluid."""

    model_config = sourced(OURS)

    count: int = field(2, ge=1, le=16, unit="creatures")
    """Number of copies, the creature included."""
    arrangement: Literal["row", "column", "grid"] = "column"
    """Places at the start, about the middle of the box: one behind the other along x (row),
    side by side along y (column), or both, with as many columns as rows or one more (grid)."""
    spacing: float = field(16.0, ge=2.0, le=1024.0, unit="cells")
    """Distance between neighbouring places."""

    @property
    def shape(self) -> tuple[int, int]:
        """Return the places along x and along y."""
        if self.arrangement == "grid":
            columns = ceil(sqrt(self.count))
            return columns, ceil(self.count / columns)
        return (self.count, 1) if self.arrangement == "row" else (1, self.count)

    @property
    def places(self) -> np.ndarray:
        """Return the places (copy, 2) about their mean, in cells."""
        number = np.arange(self.count)
        columns = self.shape[0]
        found = self.spacing * np.stack([number % columns, number // columns], 1)
        return found - found.mean(0)
