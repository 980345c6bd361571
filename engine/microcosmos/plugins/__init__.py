"""Plug-ins: fitnesses, descriptors, bodies, gaits and encodings of users; no JAX."""

from .declaration import (
    KINDS,
    Axis,
    Declaration,
    body,
    descriptor,
    encoding,
    fitness,
    gait,
    is_plugin,
)
from .loading import FailedModule, load, load_all
from .registry import LOADED, Broken, Catalogue, Missing, Plugin, find, loaded
