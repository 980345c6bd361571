"""The command line. JAX is loaded only to compute."""

from . import creature, draw, network, run
from .app import app

__all__ = ["app", "creature", "draw", "network", "run"]
