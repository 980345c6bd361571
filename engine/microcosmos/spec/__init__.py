"""Specs: validated models of everything that a run can be, with all defaults."""

from .bandit import Bandit
from .base import Part, field_path
from .body import Body, Chain, GrownBody, PluginBody, SwimmerBody, is_unavailable, shape
from .breeding import Breeding, breeding_refusal
from .control import OUTPUTS, Control, Genome
from .copies import Copies
from .coupling import Coupling
from .drawing import Drawing, drawing
from .emitters import Emitter
from .encodings import (
    BodyGraph,
    Bounds,
    Controller,
    Direct,
    Grown,
    PluginControl,
    Weights,
    gene_count,
)
from .estimate import Estimate, estimate
from .evolution import Evolution
from .experiments import EXPERIMENTS, Experiment, Preset, Spec, parse
from .flow import Flow
from .folding import Digit, Folding, Picture, picture
from .gaits import Gaits
from .neuroevolution import Neuroevolution
from .obstacles import Pattern, Post, Wall, solid_runs
from .plugins import PluginUse, PluginVersion, plugins_in
from .quality_diversity import QualityDiversity
from .reevaluation import Reevaluation
from .refinement import Refinement
from .scaling import Scaling
from .scene import Fold, Gait, Scene
from .search import (
    Archive,
    Descriptor,
    Generations,
    Screening,
    Search,
    Stop,
    Task,
)
from .world import Energy, Steric, World
