"""Elastic filaments: planar Cosserat rods by constraint projection."""

from .chunks import first_chunk as first_chunk
from .projection import Pairing as Pairing
from .projection import Rest as Rest
from .projection import Rods as Rods
from .projection import edge_angles as edge_angles
from .projection import follow_geometry as follow_geometry
from .projection import normals as normals
from .projection import project as project
from .projection import wrap as wrap
