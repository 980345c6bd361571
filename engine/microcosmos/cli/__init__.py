"""The command line. JAX is loaded only to compute."""

from . import creature, draw, modules, network, pictures, refine, run
from .app import app

__all__ = ["app", "creature", "draw", "modules", "network", "pictures", "refine", "run"]
