"""Specs: validated models of everything that a run can be, with all defaults."""

from .base import Part, field_path, invalid_fields
from .body import Body, Chain, GrownBody, PluginBody, SwimmerBody, is_unavailable, shape
from .control import OUTPUTS, Control, Genome
from .coupling import Coupling
from .drawing import Drawing, drawing
from .emitters import Emitter, PluginEmitter
from .encodings import (
    BodyGraph,
    Bounds,
    Controller,
    Direct,
    PluginControl,
    gene_count,
)
from .estimate import Estimate, estimate
from .evolution import Evolution
from .experiments import EXPERIMENTS, Experiment, Preset, Spec, parse
from .folding import Digit, Folding, Picture, picture
from .gaits import Gaits
from .neuroevolution import Neuroevolution
from .plugins import PluginUse, PluginVersion, plugins_in
from .quality_diversity import QualityDiversity
from .refinement import Refinement
from .scaling import Scaling
from .scene import Fold, Gait, Scene
from .search import (
    Archive,
    Breeding,
    Descriptor,
    Generations,
    Reevaluation,
    Screening,
    Search,
    Stop,
    Task,
    breeding_refusal,
)
from .world import Copies, Energy, Flow, Pattern, Post, Steric, Wall, World, solid_runs
