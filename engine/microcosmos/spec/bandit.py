"""Division of each batch among emitters by their success."""

from .base import Part, field, sourced
from .sources import BANDIT


class Bandit(Part):
    """Division of each batch by how many offspring of an emitter entered the archive.

    Each slot goes to the emitter with the largest share of offspring that entered plus the
    uncertainty of this share (UCB1). The emitters' `share` divides the first generation.
    """

    model_config = sourced(BANDIT)

    window: int = field(50, ge=1, le=1_000_000, unit="generations")
    """Latest generations whose offspring count."""
    exploration: float = field(0.05, ge=0.0, le=10.0)
    """Weight ζ of the uncertainty: the larger, the more equal are the parts."""
