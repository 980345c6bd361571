"""Figures of experiments, and files of them."""

from pathlib import Path
from typing import Any

from ...archive.table import read_table
from ...optional import require
from .gait_sweep import sweep
from .scaling import scaling

__all__ = ["of", "save", "scaling", "sweep"]

UNDATED = {
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": None},
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}
"""What is left out of each kind of file, so that the same figure gives the same bytes."""


def of(data: bytes) -> Any:
    """The figure of a run's file. Raises `ValueError` where it has none."""
    table = read_table(data)
    if table.experiment == "gaits":
        return sweep(table.rows)
    if table.experiment == "scaling":
        from ...experiments.scaling import summary  # Which loads JAX.

        return scaling(table.rows, summary(table.rows))
    if table.experiment == "folding":
        from .folding import folds  # Which simulates the filaments.

        return folds(data)
    needed = "gaits, scaling or folding"
    raise ValueError(f"`experiment` must be {needed}, got {table.experiment!r}.")


def save(figure: Any, path: str | Path) -> None:
    """Writes a figure as .png, .svg or .pdf."""
    suffix = Path(path).suffix.lower()
    if suffix not in UNDATED:
        raise ValueError(f"`path` must end in {', '.join(UNDATED)}, got {str(path)!r}.")
    with require("matplotlib").rc_context({"svg.hashsalt": "microcosmos"}):
        figure.savefig(path, dpi=160, metadata=UNDATED[suffix])
