"""Elastic filaments: planar Cosserat rods by constraint projection."""

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
    "follow_geometry",
    "normals",
    "project",
    "wrap",
]
