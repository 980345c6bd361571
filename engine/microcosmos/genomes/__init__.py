"""What is inherited and varied, and how it becomes a controller."""

from .cppn import ACTIVATIONS, CPPN, depths, evaluate
from .development import OUTPUTS, Controls, develop, linear, respond, sine_cosine
from .identity import empty, from_genes, take, to_genes

__all__ = [
    "ACTIVATIONS",
    "CPPN",
    "OUTPUTS",
    "Controls",
    "depths",
    "develop",
    "empty",
    "evaluate",
    "from_genes",
    "linear",
    "respond",
    "sine_cosine",
    "take",
    "to_genes",
]
