"""Plug-ins: fitnesses, descriptors, bodies, gaits and encodings of users; no JAX."""

from .declaration import KINDS, Axis, Declaration, is_plugin
from .declaring import body, descriptor, encoding, fitness, gait
from .loading import Unloaded, load, load_all, load_module
from .registry import LOADED, Broken, Catalogue, Missing, Plugin, find, loaded
