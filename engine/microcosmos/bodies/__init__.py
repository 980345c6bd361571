"""Bodies as NumPy data; JAX-free, so that a spec can be checked anywhere."""

from .assembly import placed, together
from .builders import arc, chain, from_graph, graph, ring, star, tree, walk
from .checks import MIN_GAP
from .colouring import Colour, colour
from .curve import polyline, svg
from .extent import extent, refuse_outside
from .graph import Body
from .refine import Refined, subdivided
from .shape import from_edges
from .thinning import thinned
from .unfolding import Unfolded, drawn, unfolded
