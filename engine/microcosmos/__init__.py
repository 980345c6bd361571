"""Evolve swimming creatures: filaments in a viscous fluid, NEAT inside quality-diversity.

Names are loaded when they are first used (PEP 562), so that importing the library, or its
JAX-free parts, does not load JAX.
"""

from importlib import import_module
from typing import Any

from .version import VERSION as __version__

_HOME = {
    "Client": "client",
    "EXPERIMENTS": "spec",
    "Folding": "spec",
    "Gaits": "spec",
    "Neuroevolution": "spec",
    "QualityDiversity": "spec",
    "Refinement": "spec",
    "Scaling": "spec",
    "parse": "spec",
    "evolve": "build.local",
    "refine": "build.local",
    "prepare": "device",
    "ArchiveMap": "widgets",
    "Player": "widgets",
    "record": "viz.replay",
    "show": "viz",
    "audit": "audit",
    "check": "audit",
    "gradient": "audit",
    "report_gradient": "audit",
    "export": "exports.formats",
    "Publication": "exports.crate",
    "to_arrow": "exports.arrow",
    "to_xarray": "exports.dataset",
    "learned_axes": "archive.learned",
    "physical": "quantities.files",
    "pose_streams": "archive.export",
    "to_pandas": "archive.export",
    "to_ribs": "archive.export",
    "ribs_function": "build",
    "scoring_function": "build",
    "to_repertoire": "build",
}

__all__ = [*_HOME, "__version__"]  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)


def __dir__() -> list[str]:
    return sorted(__all__)
