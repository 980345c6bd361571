"""Networks outside of JAX: evaluated, exchanged with TensorNEAT, drawn and written out."""

from .code import numpy_code as numpy_code
from .drawing import dot as dot
from .drawing import svg as svg
from .evaluation import agree as agree
from .evaluation import evaluate as evaluate
from .evaluation import probes as probes
from .file import dump_tensorneat as dump_tensorneat
from .file import load_tensorneat as load_tensorneat
from .formula import formula as formula
from .genes import from_genes as from_genes
from .genes import of_creature as of_creature
from .genes import to_genes as to_genes
from .network import Network as Network
from .reading import read_tensorneat as read_tensorneat
from .writing import Genome as Genome
from .writing import write_tensorneat as write_tensorneat
