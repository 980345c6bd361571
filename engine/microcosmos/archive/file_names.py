"""Name the files that belong to another file."""

from pathlib import Path

ENDINGS = (".json", ".yaml", ".yml", ".h5", ".hdf5")
"""Endings of specs, studies, creatures and archives; the `.05` of `nu0.05` is none."""


def stem(path: Path) -> str:
    """Return the name of a file without its ending."""
    return path.stem if path.suffix.lower() in ENDINGS else path.name


def beside(path: Path, ending: str) -> Path:
    """Return the path of a file beside this one, with its name and another ending."""
    return path.with_name(stem(path) + ending)
