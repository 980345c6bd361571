"""Search: evaluation by blocks, variation, and insertion into an archive."""

from . import cvt, disturbance, emitters, folding, gradients, loop, parts, screening, state_file
from .ask_tell import ListedElites, Networks, Search, Space, Vectors
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
from .emitters import NO_PARENT, OPERATORS, Children, Emitter, Outcome
from .evaluation import (
    STATUSES,
    STROKE_MEASURES,
    Conditions,
    Evaluation,
    evaluate,
    in_conditions,
    in_trials,
    judged,
    motion_of,
    poses_of,
    swim,
)
from .gradients import GradientReport, Slopes, report_gradient, slopes
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
from .task import Actuator, Goal, Task
from .window import Poses, crossing
