"""What users add of their own: fitnesses, descriptors, bodies, gaits and encodings; no JAX."""

from .declaration import KINDS, Axis, Declaration, is_own
from .declaring import body, descriptor, encoding, fitness, gait
from .loading import Unloaded, load, load_all, load_module
from .registry import LOADED, Broken, Known, Missing, Plugin, find, loaded

__all__ = [
    "KINDS",
    "LOADED",
    "Axis",
    "Broken",
    "Declaration",
    "Known",
    "Missing",
    "Plugin",
    "Unloaded",
    "body",
    "descriptor",
    "encoding",
    "find",
    "fitness",
    "gait",
    "is_own",
    "load",
    "load_all",
    "load_module",
    "loaded",
]
