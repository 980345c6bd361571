"""Exchange with QDax (Chalumeau et al., JMLR 25, 2024): repertoires, scoring and emitters.

QDax is imported where it is needed.
"""

from .emitters import NeatEmitter, QdaxEmitter, cma_me
from .repertoires import from_repertoire, order, require_qdax, scoring_function, to_repertoire
