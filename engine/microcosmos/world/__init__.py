"""One world: a periodic box of viscous fluid with bodies in it, in lattice units."""

from . import gpu, native
from .controller import Actuators, Controller, Network, Series
from .model import (
    Form,
    Limits,
    Measures,
    State,
    World,
    at_rest,
    centre,
    flow,
    grown_nodes,
    grown_rods,
    mean,
    present_edges,
    present_joints,
    with_bodies,
)
from .nodes import repel, sense
from .stepping import follow, keep_memory, move, rollout, step
