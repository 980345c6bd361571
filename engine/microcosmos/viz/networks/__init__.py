"""Networks outside of JAX: evaluated, exchanged with TensorNEAT, drawn and written out."""

from .code import numpy_code
from .dot import dot
from .drawing import svg
from .evaluation import agree, evaluate, probes
from .file import dump_tensorneat, load_tensorneat
from .formula import formula
from .genes import from_genes, of_creature, to_genes
from .network import Network
from .reading import read_tensorneat
from .writing import Genome, write_tensorneat

__all__ = [
    "Genome",
    "Network",
    "agree",
    "dot",
    "dump_tensorneat",
    "evaluate",
    "formula",
    "from_genes",
    "load_tensorneat",
    "numpy_code",
    "of_creature",
    "probes",
    "read_tensorneat",
    "svg",
    "to_genes",
    "write_tensorneat",
]
