"""Bodies as NumPy data; JAX-free, so that a spec can be checked anywhere."""

from .chain import chain
from .graph import Body, Colour, colour

__all__ = ["Body", "Colour", "chain", "colour"]
