"""Search: evaluation by blocks, variation, and insertion into an archive."""

from . import cvt, emitters, folding, gradients, reevaluation, screening
from .ask_tell import Found, Search
from .blocks import (
    Devices,
    LocalDevices,
    Stopped,
    block_program,
    blocks_of,
    evaluate_blocks,
    joined,
    mapped,
    never,
)
from .cells import Axis, Cells, Grid, Voronoi, places, voronoi
from .containers import (
    Container,
    DominatedNovelty,
    FrontFigures,
    Fronts,
    LearnedAxes,
    Survival,
    best_of_cells,
    cells_of,
    crowding_distance,
    dominated_novelty,
    front,
    front_figures,
    hypervolume,
    insert,
    insert_program,
    learned_axes,
    refreshed,
    with_cells,
)
from .crossing import crossing
from .emitters import NO_PARENT, OPERATORS, Children, Emitter, Outcome
from .evaluation import (
    STATUSES,
    Evaluation,
    evaluate,
    in_trials,
    judged,
    motion_of,
    poses_of,
)
from .gradient_report import GradientReport, report_gradient
from .gradients import Slopes, slopes
from .inputs import Inputs, NotCovered, inputs
from .insertion import (
    Elites,
    Inserted,
    candidates,
    clipped,
    digest,
    no_elites,
)
from .measures import MEASURES, Measure, Motion, motion, observe
from .simulation import drive, shift_energy, simulate, turned
from .spaces import Networks, Space, Vectors
from .strokes import STROKE_MEASURES, Conditions, in_conditions, swim
from .task import Actuator, Goal, Task
from .window import Poses
