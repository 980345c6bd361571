"""Figures of experiments without an archive, and their files."""

from pathlib import Path
from typing import Any

from ...archive.atomic import write_whole
from ...archive.file import read_table
from .gait_sweep import sweep
from .saving import encoded, kind
from .scaling import scaling

__all__ = ["of", "save", "scaling", "sweep"]


def of(data: bytes) -> Any:
    """Return the figure of a run's file. Raises `ValueError` for other experiments."""
    table = read_table(data)
    if table.experiment == "gaits":
        return sweep(table.rows)
    if table.experiment == "scaling":
        from ...experiments.scaling import summary  # Loads JAX.

        return scaling(table.rows, summary(table.rows))
    if table.experiment == "folding":
        from .folding import folds  # Loads JAX.

        return folds(data)
    needed = "gaits, scaling or folding"
    raise ValueError(f"`experiment` must be {needed}, got {table.experiment!r}.")


def save(figure: Any, path: str | Path) -> None:
    """Write a figure as .pdf, .svg or .png."""
    write_whole(Path(path), encoded(figure, kind(Path(path)), dpi=160))
