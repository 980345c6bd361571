"""Everything a run can be, validated: the only place where a default is written."""

from .base import Part
from .control import OUTPUTS, Control, Genome
from .estimate import Estimate, estimate
from .experiments import EXPERIMENTS, Experiment, Preset, Spec, parse
from .quality_diversity import QualityDiversity
from .search import Archive, Descriptor, Search, Task
from .world import Body, Coupling, World

__all__ = [
    "EXPERIMENTS",
    "OUTPUTS",
    "Archive",
    "Body",
    "Control",
    "Coupling",
    "Descriptor",
    "Estimate",
    "Experiment",
    "Genome",
    "Part",
    "Preset",
    "QualityDiversity",
    "Search",
    "Spec",
    "Task",
    "World",
    "estimate",
    "parse",
]
