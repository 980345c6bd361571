"""Genotypes and encodings: inherited genes, and their development into moving creatures."""

from .actuators import Actuators, carried_out
from .body_graph import BodyGraphEncoding
from .control import CPPNControl
from .cppn import ACTIVATIONS, CPPN, evaluate, minimal
from .development import Controls, develop, function_of, linear, rest_shape, sine_cosine
from .direct import Direct
from .encoding import Drive, Encoding
from .fold import FoldEncoding, added, scaled
from .genotype import (
    SEGMENT,
    Genotype,
    Graph,
    Vector,
    columns,
    empty,
    from_columns,
    from_genes,
    read,
    take,
    to_genes,
    words,
    write,
)
from .grown import Grown
from .plan import BodyGraph
from .plugin import Clock, PluginEncoding
from .recurrent import advance
from .waves import fourier, phases, table, wave
from .weights import Layers, Weights, forward
