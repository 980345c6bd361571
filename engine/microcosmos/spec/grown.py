"""Bodies that grow: their largest sizes."""

from typing import Literal

from ..bodies import growth
from .base import Part, field


class GrownBody(Part):
    """A body that grows from a plan of segments in the genome: its largest sizes."""

    builder: Literal["grown"]
    nodes: int = field(48, ge=8, le=256, unit="nodes")
    """Most nodes of a body."""
    length: float = field(40.0, ge=4.0, le=1000.0, unit="cells")
    """Largest distance between two nodes along a body."""
    segments: int = field(8, ge=1, le=32)
    """Most segments of a plan."""
    segment_nodes: int = field(24, ge=growth.LEAST_ROOT, le=128, unit="nodes")
    """Most nodes of a segment."""
    copies: int = field(6, ge=1, le=32)
    """Most copies of a segment along the one that it is attached to."""
    limbs: int = field(12, ge=1, le=64)
    """Most copies of a segment in a body, with those of its parents and mirror images."""
    rings: int = field(3, ge=1, le=8)
    """Most rings of a body."""
    spacing: float = field(1.0, ge=0.5, le=2.0, unit="cells")
    """Rest length of an edge; above 2 cells, fluid leaks between the nodes."""

    @property
    def capacity(self) -> growth.Capacity:
        """Return the fixed sizes of all bodies; the last row of nodes stays empty."""
        return growth.Capacity(
            nodes=self.nodes + 1,
            segments=self.segments,
            rings=self.rings,
            limbs=self.limbs,
            length=self.length,
            spacing=self.spacing,
        )

    @property
    def genes(self) -> growth.Segments:
        """Return the limits of the genes of segments."""
        return growth.Segments(self.segments, self.segment_nodes, self.copies)
