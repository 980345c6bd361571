"""What is inherited and varied, and how it becomes a creature that moves."""

from .control import CPPNControl
from .cppn import ACTIVATIONS, CPPN, depths, evaluate, minimal
from .development import OUTPUTS, Controls, develop, linear, respond, sine_cosine
from .encoding import Drive, Encoding
from .genes import empty, from_genes, take, to_genes
from .genotype import Genotype, Vector, words

__all__ = [
    "ACTIVATIONS",
    "CPPN",
    "OUTPUTS",
    "CPPNControl",
    "Controls",
    "Drive",
    "Encoding",
    "Genotype",
    "Vector",
    "depths",
    "develop",
    "empty",
    "evaluate",
    "from_genes",
    "linear",
    "minimal",
    "respond",
    "sine_cosine",
    "take",
    "to_genes",
    "words",
]
