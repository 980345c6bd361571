"""One world: a periodic box of viscous fluid with bodies in it, in lattice units."""

from . import gpu, native, senses, slots
from .controller import SENSES, Actuators, Controller, Network, Series
from .model import (
    Form,
    Limits,
    Measures,
    Route,
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
    route,
    together,
    unwrapped,
    with_bodies,
    within_box,
)
from .nodes import repel, sense
from .stepping import follow, keep_memory, move, rollout, step
