"""Bodies as NumPy data; JAX-free, so that a spec can be checked anywhere."""

from . import growth
from .anatomy import Anatomy, anatomy
from .builders import arc, chain, from_graph, graph, ring, star, tree, walk
from .checks import MIN_GAP
from .colouring import Colour, colour
from .curve import polyline, svg
from .graph import Body, combined, placed
from .layout import Layout, is_exact, layout, pieces
from .resolution import Refined, subdivided, thinned
from .shape import extent, from_edges
