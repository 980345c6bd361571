"""The measures of every evaluation, and the default axis of each."""

from dataclasses import dataclass
from typing import Literal

Scale = Literal["log10", "linear"]


@dataclass(frozen=True)
class Measure:
    """A measure: its title and unit, and the default ends and scale of its axis."""

    title: str
    unit: str
    low: float
    high: float
    scale: Scale = "linear"


WORK = "mass · cells²/step² per length"

MEASURES: dict[str, Measure] = {
    "displacement": Measure("Displacement", "cells", 0.0, 20.0),
    "bending_effort": Measure("Bending effort", "rad²", 1e-4, 1e2, "log10"),
    "stretching_effort": Measure("Stretching effort", "cells²", 1e-4, 1e2, "log10"),
    "path_length": Measure("Path length", "cells", 0.0, 40.0),
    "straightness": Measure("Straightness", "", 0.0, 1.0),
    "rotation": Measure("Rotation", "rad", -6.3, 6.3),
    "hidden_nodes": Measure("Hidden nodes", "", 0.0, 20.0),
    "connections": Measure("Connections", "", 0.0, 60.0),
    "energy": Measure("Energy collected", "energy", 1e-2, 1e5, "log10"),
    "mach": Measure("Largest Mach number", "", 1e-3, 1.0, "log10"),
    "limited": Measure("Node steps at a limit", "share", 0.0, 1.0),
    "reynolds": Measure("Reynolds number", "", 1e-2, 1e2, "log10"),
    "mean_speed": Measure("Mean speed", "cells/step", 1e-5, 1e-1, "log10"),
    "turning": Measure("Turning", "rad", 1e-3, 1e1, "log10"),
    "curvature_mean": Measure("Mean curvature", "1/cells", 0.0, 0.3),
    "curvature_spread": Measure("Spread of curvature", "1/cells", 0.0, 0.5),
    "symmetry": Measure("Symmetry", "", -1.0, 1.0),
    "power": Measure("Power", "mass · cells²/step³", 1e-7, 1.0, "log10"),
    "efficiency": Measure("Efficiency", "", 1e-6, 1.0, "log10"),
    "nodes": Measure("Nodes", "", 0.0, 64.0),
    "speed": Measure("Speed", "lengths/1,000 steps", 0.0, 0.6),
    "stride": Measure("Stride", "lengths", 0.0, 0.3),
    "impulse": Measure("Net impulse", "mass · cells/step", 1e-8, 1e2, "log10"),
    "cost_of_transport": Measure("Cost of transport", WORK, 1.0, 1e3, "log10"),
    "beats": Measure("Beats", "per stroke", 0.0, 8.0),
    "wave_number": Measure("Wave number", "waves per length", 0.0, 3.0),
    "wave_direction": Measure("Direction of the wave", "", -1.0, 1.0),
    "heading_angle": Measure("Heading to the axis", "rad", 0.0, 1.58),
    "aspect": Measure("Width over length", "", 0.0, 1.0),
    "strouhal": Measure("Strouhal number", "", 1e-1, 1e3, "log10"),
    "advance": Measure("Advance", "lengths/1,000 steps", -0.6, 0.6),
    "trial_spread": Measure("Spread over trials", "fitness", 0.0, 0.1),
    "segments": Measure("Segments", "", 0.5, 12.5),
    "free_ends": Measure("Free ends", "", -0.5, 11.5),
    "rings": Measure("Rings", "", -0.5, 3.5),
    "total_length": Measure("Total length", "cells", 0.0, 50.0),
    "form_symmetry": Measure("Mirror symmetry at rest", "", 0.0, 1.0),
    "form_aspect": Measure("Width over length at rest", "", 0.0, 1.0),
    "ungrown": Measure("Segments without room", "", -0.5, 8.5),
    "crossing": Measure("Poses in which filaments cross", "share", 0.0, 1.0),
}
"""The measures, in the order in which they are recorded."""
