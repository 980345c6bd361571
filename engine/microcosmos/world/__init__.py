"""One world: a periodic box of viscous fluid with bodies in it, in lattice units."""

from . import gpu, native
from .controller import Actuators, Controller, Network, Series
from .model import Form, Limits, Measures, State, World, at_rest, flow, with_bodies
from .nodes import repel, sense
from .present import centre, edges_there, grown_nodes, grown_rods, joints_there, mean
from .rolling import follow, keep_memory, rollout
from .stepping import move, step
