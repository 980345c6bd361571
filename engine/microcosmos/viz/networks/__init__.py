"""Networks outside of JAX: evaluated, exchanged with TensorNEAT, drawn and written out."""

from .code import numpy_code
from .drawing import dot, svg
from .evaluation import agree, evaluate, probes
from .file import dump_tensorneat, load_tensorneat
from .formula import formula
from .genes import from_genes, of_creature, to_genes
from .network import Network
from .positions import NetworkPositions, positions
from .reading import read_tensorneat
from .writing import Genome, write_tensorneat
