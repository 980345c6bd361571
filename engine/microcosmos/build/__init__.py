"""Build the objects of a run from its spec: the only place where pydantic meets JAX."""

from .encodings import build_controls, build_encoding
from .experiments import (
    build,
    build_crowd,
    build_descent,
    build_gaits,
    build_pictures,
    build_scaling,
)
from .peers import ribs_function, scoring_function, to_repertoire
from .plan import build_axes, build_cells, build_emitters, build_rates
from .plugins import build_measures, measures_of
from .scene import (
    build_block,
    build_energy,
    build_flow,
    build_layout,
    build_limits,
    build_matching,
    build_point,
    build_rods,
    build_start,
    build_steric,
    build_stroke,
    build_stroke_block,
    build_surroundings,
    build_task,
    build_world,
    identity_template,
    matching_of,
)
