"""Exchange with QDax (Chalumeau et al., JMLR 25, 2024): repertoires, scoring and emitters.

QDax is imported where it is needed.
"""

from .emitters import NeatEmitter as NeatEmitter
from .emitters import QdaxEmitter as QdaxEmitter
from .emitters import cma_me as cma_me
from .repertoires import from_repertoire as from_repertoire
from .repertoires import needed as needed
from .repertoires import order as order
from .repertoires import scoring_function as scoring_function
from .repertoires import to_repertoire as to_repertoire
