"""Plug-ins: fitnesses, descriptors, bodies, gaits, encodings and emitters of users; no JAX."""

from .declaration import (
    KINDS,
    Axis,
    Declaration,
    Emits,
    Kind,
    body,
    descriptor,
    emitter,
    encoding,
    fitness,
    gait,
    is_plugin,
)
from .loading import FailedModule, load, load_all
from .registry import LOADED, Broken, Catalogue, Missing, Plugin, find, loaded
