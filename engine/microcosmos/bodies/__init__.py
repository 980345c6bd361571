"""Bodies as NumPy data; JAX-free, so that a spec can be checked anywhere."""

from . import growth
from .anatomy import Anatomy, anatomy
from .builders import arc, chain, from_graph, graph, polyline, ring, star, svg, tree, walk
from .graph import MIN_GAP, Body, Colour, colour, combined, placed
from .layout import Layout, is_exact, layout, pieces
from .resolution import Refined, subdivided, thinned
from .shape import extent, from_edges, reach, rings
