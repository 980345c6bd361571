"""Build the objects of a run from its spec: the only place where pydantic meets JAX."""

from .cells import build_axes, build_cells
from .creatures import build_block, build_point, build_stroke_block, identity_template
from .emitters import build_emitters, build_rates
from .encodings import build_controls, build_encoding
from .experiments import build, build_plan
from .folding import build_descent, build_pictures
from .peers import ribs_function, scoring_function, to_repertoire
from .plugins import build_measures, measures_of
from .scene import (
    build_energy,
    build_layout,
    build_limits,
    build_matching,
    build_rods,
    build_steric,
    build_stroke,
    build_task,
    build_world,
    matching_of,
)
from .surroundings import build_flow, build_start, build_surroundings
from .tables import build_crowd, build_gaits, build_scaling
