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
