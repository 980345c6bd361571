"""One world: a periodic box of viscous fluid with bodies in it, in lattice units."""

from .model import Form, Limits, Measures, State, World, at_rest, flow
from .nodes import repel, sense
from .rolling import follow, rollout
from .stepping import Motion, move, step

__all__ = [
    "Form",
    "Limits",
    "Measures",
    "Motion",
    "State",
    "World",
    "at_rest",
    "flow",
    "follow",
    "move",
    "repel",
    "rollout",
    "sense",
    "step",
]
