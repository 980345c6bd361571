"""The five known swimmers of the Microcosmos paper and their gaits; free of JAX."""

from .cilia import cilia
from .jellyfish import jellyfish
from .ray import ray
from .swimmer import Gait, Swimmer
from .undulating import tadpole, worm

SWIMMERS = {
    "worm": worm,
    "tadpole": tadpole,
    "ray": ray,
    "cilia": cilia,
    "jellyfish": jellyfish,
}

__all__ = [
    "SWIMMERS",
    "Gait",
    "Swimmer",
    "cilia",
    "jellyfish",
    "ray",
    "tadpole",
    "worm",
]
