"""Is everything here that Microcosmos needs, and what to do where it is not."""

from .examination import examine
from .finding import Finding

__all__ = ["Finding", "examine"]
