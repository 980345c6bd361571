"""Elastic filaments: planar Cosserat rods by constraint projection."""

from .chunks import first_chunk
from .matching import Layout, fitted, matched, rest_positions, softened, standing, turns
from .projection import (
    Pairing,
    Rest,
    Rings,
    Rods,
    closed,
    edge_angles,
    follow_geometry,
    normals,
    project,
    wrap,
)
