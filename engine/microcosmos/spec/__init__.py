"""Everything a run can be, validated: the only place where a default is written."""

from .base import Part, field_path
from .body import Body, Chain, Known, PluginBody, made_elsewhere, shape
from .control import OUTPUTS, Control, Genome
from .coupling import Coupling
from .drawing import Drawing, drawing
from .emitters import Emitter
from .encodings import (
    Controller,
    Direct,
    Free,
    Grown,
    PluginControl,
    Weights,
    genes,
    lengthening,
)
from .estimate import Estimate, estimate
from .evolution import Evolution
from .experiments import EXPERIMENTS, Experiment, Preset, Spec, parse
from .fields import Energy, Steric
from .folding import Digit, Folding, Picture, picture
from .gaits import FORMS, Gaits
from .neuroevolution import Neuroevolution
from .plugins import PluginUse, PluginVersion, plugins_in
from .quality_diversity import QualityDiversity
from .refinement import Refinement
from .scaling import Scaling
from .scene import Fold, Gait, Scene
from .search import Archive, Descriptor, Generations, Reevaluation, Search, Stop, Task
from .world import World

__all__ = [
    "EXPERIMENTS",
    "FORMS",
    "OUTPUTS",
    "Archive",
    "Body",
    "Chain",
    "Control",
    "Controller",
    "Coupling",
    "Descriptor",
    "Digit",
    "Direct",
    "Drawing",
    "Emitter",
    "Energy",
    "Estimate",
    "Evolution",
    "Experiment",
    "Fold",
    "Folding",
    "Free",
    "Gait",
    "Gaits",
    "Generations",
    "Genome",
    "Grown",
    "Known",
    "Neuroevolution",
    "Part",
    "Picture",
    "PluginBody",
    "PluginControl",
    "PluginUse",
    "PluginVersion",
    "Preset",
    "QualityDiversity",
    "Reevaluation",
    "Refinement",
    "Scaling",
    "Scene",
    "Search",
    "Spec",
    "Steric",
    "Stop",
    "Task",
    "Weights",
    "World",
    "drawing",
    "estimate",
    "field_path",
    "genes",
    "lengthening",
    "made_elsewhere",
    "parse",
    "picture",
    "plugins_in",
    "shape",
]
