"""Bodies as NumPy data; JAX-free, so that a spec can be checked anywhere."""

from .assembly import placed, together
from .bounds import refuse_outside
from .branching import star, tree
from .chain import chain
from .checks import MIN_GAP
from .circle import arc, ring
from .colouring import Colour, colour
from .curve import polyline, svg
from .graph import Body
from .network import from_graph, graph
from .refine import Refined, subdivided
from .shape import from_edges
from .thinning import thinned
from .unfolding import Unfolded, drawn, unfolded
from .walk import walk

__all__ = [
    "MIN_GAP",
    "Body",
    "Colour",
    "Refined",
    "Unfolded",
    "arc",
    "chain",
    "colour",
    "drawn",
    "from_edges",
    "from_graph",
    "graph",
    "placed",
    "polyline",
    "refuse_outside",
    "ring",
    "star",
    "subdivided",
    "svg",
    "thinned",
    "together",
    "tree",
    "unfolded",
    "walk",
]
