"""A worker's claim on a run: the fence behind which everything of an attempt is written.

Each write is one transaction that first proves that the attempt is still the current
one. `Fenced` says that it is not: the process should end without another word.
"""

from .beginning import claim
from .fence import Claim, Fenced

__all__ = ["Claim", "Fenced", "claim"]
