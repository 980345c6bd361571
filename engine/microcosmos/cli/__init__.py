"""The command line. JAX is loaded only to compute."""

from . import (
    creature,
    doctor,
    draw,
    manage,
    modules,
    monitor,
    network,
    pictures,
    refine,
    run,
    sharing,
    submit,
)
from .app import app

__all__ = [
    "app",
    "creature",
    "doctor",
    "draw",
    "manage",
    "modules",
    "monitor",
    "network",
    "pictures",
    "refine",
    "run",
    "sharing",
    "submit",
]
