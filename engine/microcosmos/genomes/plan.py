"""Genotypes of two parts: a body plan, and the network that drives the body."""

import equinox as eqx

from ..bodies.growth import Plan
from .cppn import CPPN


class BodyGraph(eqx.Module):
    """A body plan and a network."""

    plan: Plan
    network: CPPN
