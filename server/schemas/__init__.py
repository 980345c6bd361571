"""Wire types: what the API takes and gives. Rows are in `models`."""

from .archives import ArchiveRead, Axis, CentroidsRead, Feature, HistoryRead, ResultsRead
from .base import FieldError, Problem, Wire
from .creatures import Ancestors, Children, CreatureName, Relative, Rendering
from .estimates import AheadRead, BodyRead, DrawingRead, EstimateRead, PaceRead, PictureRead
from .experiments import ExperimentRead, PresetRead
from .runs import (
    NAME,
    Curves,
    EntryRead,
    Extension,
    Forked,
    Log,
    RunChange,
    RunPage,
    RunRead,
    Species,
    Status,
    TagRead,
    Target,
)
from .workers import Carried, Health, QueueRead, Readiness, Waiting, WorkerRead

__all__ = [
    "NAME",
    "AheadRead",
    "Ancestors",
    "ArchiveRead",
    "Axis",
    "BodyRead",
    "Carried",
    "CentroidsRead",
    "Children",
    "CreatureName",
    "Curves",
    "DrawingRead",
    "EntryRead",
    "EstimateRead",
    "ExperimentRead",
    "Extension",
    "Feature",
    "FieldError",
    "Forked",
    "Health",
    "HistoryRead",
    "Log",
    "PaceRead",
    "PictureRead",
    "PresetRead",
    "Problem",
    "QueueRead",
    "Readiness",
    "Relative",
    "Rendering",
    "ResultsRead",
    "RunChange",
    "RunPage",
    "RunRead",
    "Species",
    "Status",
    "TagRead",
    "Target",
    "Waiting",
    "Wire",
    "WorkerRead",
]
