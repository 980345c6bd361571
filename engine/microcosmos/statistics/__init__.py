"""Statistics across runs: groups, rank tests, effect sizes, aggregates over tasks, tables.

`compare` compares groups of runs by measures; `across` aggregates over several tasks. SciPy
does the tests and the bootstrap; no JAX is loaded.
"""

from .aggregates import Aggregates, across
from .comparison import Comparison, compare
from .groups import Group, by_spec, named
from .measures import Measure
from .records import RunRecord, read, read_files
