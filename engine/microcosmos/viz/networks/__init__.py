"""Pictures of networks: SVG, Graphviz, and the positions of nodes as data."""

from .drawing import dot, svg
from .layout import NetworkPositions, positions
