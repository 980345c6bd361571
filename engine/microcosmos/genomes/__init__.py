"""Genotypes and encodings: inherited genes, and their development into moving creatures."""

from .actuators import Actuators, carried_out
from .body_graph import BodyGraphEncoding
from .control import CPPNControl, advance
from .cppn import ACTIVATIONS, CPPN, evaluate, minimal
from .development import Controls, develop, function_of, linear, rest_shape, sine_cosine
from .encoding import Drive, Encoding
from .genotype import (
    SEGMENT,
    BodyGraph,
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
from .vectors import (
    Clock,
    Direct,
    FoldEncoding,
    PluginEncoding,
    added,
    fourier,
    phases,
    scaled,
    table,
    wave,
)
