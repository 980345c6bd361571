"""Networks outside of JAX: evaluation, exchange with TensorNEAT, and export as text."""

from .genes import from_genes, of_creature, to_genes
from .network import Network, agree, evaluate, probes
from .tensorneat import (
    Genome,
    dump_tensorneat,
    load_tensorneat,
    read_tensorneat,
    write_tensorneat,
)
from .text import formula, numpy_code
