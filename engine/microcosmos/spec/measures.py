"""What is measured of every elite, and the axis that each makes by default."""

from dataclasses import dataclass
from typing import Literal, get_args

Scale = Literal["log10", "linear"]


@dataclass(frozen=True)
class Feature:
    """A measure, its unit, and the ends of its axis."""

    title: str
    unit: str
    low: float
    high: float
    scale: Scale = "linear"


Name = Literal[
    "displacement",
    "bending_effort",
    "stretching_effort",
    "path_length",
    "straightness",
    "rotation",
    "hidden_nodes",
    "connections",
    "energy",
    "mach",
    "limited",
    "reynolds",
    "mean_speed",
    "turning",
    "curvature_mean",
    "curvature_spread",
    "symmetry",
    "power",
    "efficiency",
    "nodes",
]
"""In the order in which they are recorded."""

FEATURES: dict[str, Feature] = {
    "displacement": Feature("Displacement", "cells", 0.0, 20.0),
    "bending_effort": Feature("Bending effort", "rad²", 1e-4, 1e2, "log10"),
    "stretching_effort": Feature("Stretching effort", "cells²", 1e-4, 1e2, "log10"),
    "path_length": Feature("Path length", "cells", 0.0, 40.0),
    "straightness": Feature("Straightness", "", 0.0, 1.0),
    "rotation": Feature("Rotation", "rad", -6.3, 6.3),
    "hidden_nodes": Feature("Hidden nodes", "", 0.0, 20.0),
    "connections": Feature("Connections", "", 0.0, 60.0),
    "energy": Feature("Energy collected", "energy", 1e-2, 1e5, "log10"),
    "mach": Feature("Largest Mach number", "", 1e-3, 1.0, "log10"),
    "limited": Feature("Node steps at a limit", "share", 0.0, 1.0),
    "reynolds": Feature("Reynolds number", "", 1e-2, 1e2, "log10"),
    "mean_speed": Feature("Mean speed", "cells/step", 1e-5, 1e-1, "log10"),
    "turning": Feature("Turning", "rad", 1e-3, 1e1, "log10"),
    "curvature_mean": Feature("Mean curvature", "1/cells", 0.0, 0.5),
    "curvature_spread": Feature("Spread of curvature", "1/cells", 0.0, 0.5),
    "symmetry": Feature("Symmetry", "", -1.0, 1.0),
    "power": Feature("Power", "mass · cells²/step³", 1e-7, 1.0, "log10"),
    "efficiency": Feature("Efficiency", "", 1e-6, 1.0, "log10"),
    "nodes": Feature("Nodes", "", 0.0, 64.0),
}

assert tuple(FEATURES) == get_args(Name)
