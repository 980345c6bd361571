"""Elastic filaments: planar Cosserat rods by constraint projection."""

from .chunks import first_chunk
from .projection import (
    Pairing,
    Rest,
    Rods,
    edge_angles,
    follow_geometry,
    normals,
    project,
    wrap,
)

__all__ = [
    "Pairing",
    "Rest",
    "Rods",
    "edge_angles",
    "first_chunk",
    "follow_geometry",
    "normals",
    "project",
    "wrap",
]
