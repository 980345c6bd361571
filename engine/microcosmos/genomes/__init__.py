"""What is inherited and varied, and how it becomes a creature that moves."""

from .control import CPPNControl
from .cppn import ACTIVATIONS, CPPN, depths, evaluate, minimal
from .development import OUTPUTS, Controls, develop, linear, respond, sine_cosine
from .direct import Direct
from .encoding import Drive, Encoding
from .fold import Fold, added, scaled
from .genes import empty, from_genes, take, to_genes
from .genotype import Genotype, Vector, words
from .grown import Grown
from .layers import Layers, forward
from .plugin import Clock, PluginEncoding
from .recurrent import advance
from .shaping import Plan
from .waves import fourier, phases, table, wave
from .weights import Weights

__all__ = [
    "ACTIVATIONS",
    "CPPN",
    "OUTPUTS",
    "CPPNControl",
    "Clock",
    "Controls",
    "Direct",
    "Drive",
    "Encoding",
    "Fold",
    "Genotype",
    "Grown",
    "Layers",
    "Plan",
    "PluginEncoding",
    "Vector",
    "Weights",
    "added",
    "advance",
    "depths",
    "develop",
    "empty",
    "evaluate",
    "forward",
    "fourier",
    "from_genes",
    "linear",
    "minimal",
    "phases",
    "respond",
    "scaled",
    "sine_cosine",
    "table",
    "take",
    "to_genes",
    "wave",
    "words",
]
