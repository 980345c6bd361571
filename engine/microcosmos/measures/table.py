"""The table of all measures.

Everything that names a measure takes it from here: specs, files, exports, figures, the native
kernel's index (`engine/kernels/src/measures.h`), the page (`web/src/api/measures.json`) and the
documentation. The first measures are computed together, by one program that `search` compiles
and by the kernel. Those of `measures.named` have a file each.
"""

from importlib import import_module
from pkgutil import iter_modules
from typing import TYPE_CHECKING, Any, Literal

from . import named
from .declaration import MARK, Measure

GROUPS = {
    "result": "Result",
    "control": "Control",
    "shape": "Shape",
    "form": "Body at rest",
    "network": "Network",
    "flow": "Flow",
}
"""Titles of the groups in which people read measures, in order."""

MOMENTUM = "mass · cells/step"
POWER = "mass · cells²/step³"
WORK = "mass · cells²/step² per length"
PACE = "lengths/1,000 steps"
FORM: Any = {"group": "form", "source": "form", "gradient": False}
NETWORK: Any = {"group": "network", "source": "genome", "gradient": False}

# Each row is read across, so the formatter leaves the table alone.
# fmt: off
_TOGETHER = (
    Measure("displacement", "Displacement", "cells", 0.0, 20.0,
        about="Distance of the mean node between start and end."),
    Measure("bending_effort", "Bending effort", "rad²", 1e-4, 1e2, "log10", group="control",
        about="Σ over time and joints of the squared change of rest angles."),
    Measure("stretching_effort", "Stretching effort", "cells²", 1e-4, 1e2, "log10",
        group="control", about="Σ over time and edges of the squared change of rest "
        "lengths."),
    Measure("path_length", "Path length", "cells", 0.0, 40.0,
        about="Length of the path of the mean node."),
    Measure("straightness", "Straightness", "", 0.0, 1.0,
        about="Displacement / path length."),
    Measure("rotation", "Rotation", "rad", -6.3, 6.3, group="shape",
        about="Change of the edges' angles, mean over edges."),
    Measure("hidden_nodes", "Hidden nodes", "", 0.0, 20.0, **NETWORK,
        about="Enabled hidden nodes of the network; 0 without a network."),
    Measure("connections", "Connections", "", 0.0, 60.0, **NETWORK,
        about="Enabled connections of the network; 0 without a network."),
    Measure("energy", "Energy collected", "energy", 0.01, 1e5, "log10",
        about="Energy collected, summed over nodes and steps."),
    Measure("mach", "Largest Mach number", "", 1e-3, 1.0, "log10", group="flow",
        about="Fastest flow anywhere × √3."),
    Measure("limited", "Node steps at a limit", "share", 0.0, 1.0, group="flow", gradient=False,
        about="Share of the node steps at a limit."),
    Measure("reynolds", "Reynolds number", "", 0.01, 1e2, "log10", group="flow",
        about="Mean speed of the nodes × reach of the body / viscosity."),
    Measure("mean_speed", "Mean speed", "cells/step", 1e-5, 0.1, "log10",
        about="Path length / steps."),
    Measure("turning", "Turning", "rad", 1e-3, 10.0, "log10", group="shape",
        about="Σ over steps of the size of the change of the mean edge angle."),
    Measure("curvature_mean", "Mean curvature", "1/cells", 0.0, 0.3, group="shape",
        about="Mean over time and joints of the size of the joint's angle / mean length "
        "of its two edges."),
    Measure("curvature_spread", "Spread of curvature", "1/cells", 0.0, 0.5, group="shape",
        about="Standard deviation of the same."),
    Measure("symmetry", "Symmetry", "", -1.0, 1.0, group="shape",
        about="Σ c(t, j) c(t, J − 1 − j) / Σ c(t, j)² over time t and joints j, c being "
        "the signed curvature less its mean over time: 1 where both halves bend "
        "alike, −1 where they bend oppositely, about 0 for a wave along the body. "
        "Joints that are present count in their order, which is that along a "
        "filament."),
    Measure("power", "Power", POWER, 1e-7, 1.0, "log10", group="control",
        about="Force on the fluid × velocity, summed over nodes, mean over steps; a "
        "cell's mass is 1."),
    Measure("efficiency", "Efficiency", "", 1e-6, 1.0, "log10", group="control",
        about="Viscosity × (displacement / steps)² / power; 0 where power is not "
        "positive."),
    Measure("nodes", "Nodes", "", 0.0, 64.0, group="shape", gradient=False,
        about="Nodes of the grown body."),
    Measure("speed", "Speed", PACE, 0.0, 0.6,
        about="Displacement of the mean node over whole strokes after the first, per "
        "reach of the body; 0 below two strokes."),
    Measure("stride", "Stride", "lengths", 0.0, 0.3,
        about="The same displacement in a stroke."),
    Measure("impulse", "Net impulse", MOMENTUM, 1e-8, 1e2, "log10", group="flow",
        about="The largest net momentum, over time, that the body has given the fluid: "
        "force × time, with a cell's mass of 1."),
    Measure("cost_of_transport", "Cost of transport", WORK, 1.0, 1e3, "log10",
        about="Work on the fluid per body length of displacement, over whole strokes "
        "after the first."),
    Measure("beats", "Beats", "per stroke", 0.0, 8.0,
        about="Mean frequency of the curvature over the last two strokes: 1 where the "
        "body bends once a stroke."),
    Measure("wave_number", "Wave number", "waves per length", 0.0, 3.0,
        about="Waves of curvature along the length of the body, at the strongest "
        "frequency."),
    Measure("wave_direction", "Direction of the wave", "", -1.0, 1.0,
        about="1 where this wave travels from the first node to the last, −1 for the "
        "reverse, 0 for a standing wave."),
    Measure("heading_angle", "Heading to the axis", "rad", 0.0, 1.58,
        about="Angle from the body's long axis to its displacement over the last two "
        "strokes, 0 to π/2."),
    Measure("aspect", "Width over length", "", 0.0, 1.0,
        about="Width over length of the body, by the second moments of its nodes over the "
        "last two strokes."),
    Measure("strouhal", "Strouhal number", "", 0.1, 1e3, "log10", group="flow",
        about="Strokes per step × the largest excursion of a node across the displacement "
        "/ speed."),
    Measure("advance", "Advance", PACE, -0.6, 0.6,
        about="The part of `speed` along x, with its sign: negative along −x, which is "
        "upstream in a channel."),
    Measure("trial_spread", "Spread over trials", "fitness", 0.0, 0.1, source="trials",
        gradient=False, about="Standard deviation of fitness over `task.trials`; 0 with "
        "one."),
    Measure("segments", "Segments", "", 0.5, 12.5, **FORM,
        about="Filaments of the body between its free ends and branches; a lone ring "
        "counts as one."),
    Measure("free_ends", "Free ends", "", -0.5, 11.5, **FORM,
        about="Nodes with one edge."),
    Measure("rings", "Rings", "", -0.5, 3.5, **FORM,
        about="Independent loops: edges − nodes + connected pieces."),
    Measure("total_length", "Total length", "cells", 0.0, 50.0, **FORM,
        about="Σ over edges of their lengths at rest."),
    Measure("form_symmetry", "Mirror symmetry at rest", "", 0.0, 1.0, **FORM,
        about="Of the body at rest, for the best mirror through the mean node: 1 − the "
        "mean distance from a mirrored node to the nearest node / half the radius "
        "of gyration, at least 0. Mirrors lie along and across the first axis, the "
        "axes of the second moments, and the way to the farthest node."),
    Measure("form_aspect", "Width over length at rest", "", 0.0, 1.0, **FORM,
        about="Width over length of the body at rest, by the second moments of its nodes."),
    Measure("ungrown", "Segments without room", "", -0.5, 8.5, **FORM,
        about="Segments of a plan for which there was no room; 0 without a plan."),
    Measure("crossing", "Poses in which filaments cross", "share", 0.0, 1.0, group="shape",
        source="poses", gradient=False,
        about="Share of the recorded poses of the last two strokes in which two edges cross "
        "that do not at the start."),
)
# fmt: on
"""Measures of every evaluation. Files list them in this order, so new ones go behind."""

_OTHERS = (
    *(
        Measure(
            f"cycle_{axis}",
            f"Displacement along {axis} in the last cycle",
            "cells",
            -10.0,
            10.0,
            about=f"Displacement of the mean node along {axis} in the last period of a gait.",
            recorded="gaits",
        )
        for axis in "xy"
    ),
    Measure(
        "sperm",
        "Sperm number",
        "",
        0.1,
        10.0,
        "log10",
        "flow",
        "Fourth root of the frequency of strokes × the relaxation time of the shape, in rad.",
        "genome",
        "never",
    ),
)
"""Numbers that are shown beside the measures, and are no descriptors."""


def _named() -> tuple[Measure, ...]:
    """Return the measures that have a file each, by name."""
    modules = [
        import_module(f"{named.__name__}.{one.name}") for one in iter_modules(named.__path__)
    ]
    declared = (getattr(one, MARK, None) for each in modules for one in vars(each).values())
    return tuple(sorted(filter(None, declared), key=lambda one: one.name))


MEASURES = {one.name: one for one in (*_TOGETHER, *_named(), *_OTHERS)}
"""All measures by name."""


def _names(*recorded: str) -> tuple[str, ...]:
    return tuple(name for name, one in MEASURES.items() if one.recorded in recorded)


RECORDED = _names("always")
"""Names of the measures of every evaluation, in the order of files."""
NAMED = _names("named")
"""Names of the measures that are recorded where a spec names them, behind the others."""
FORMS = tuple(name for name, one in MEASURES.items() if one.source == "form")
"""Names of the measures of form; see `bodies.growth.form`."""
WITHOUT_GRADIENT = tuple(name for name, one in MEASURES.items() if not one.gradient)
"""Names of measures without derivatives: counts, the form at rest, shares."""
SUMMARISED = tuple(name for name in RECORDED if MEASURES[name].source == "motion")
"""Names of the measures that the native kernel computes, in the order of its index."""

# Type checkers take no computed names.
if TYPE_CHECKING:
    MeasureName = str
else:
    MeasureName = Literal[(*RECORDED, *NAMED)]
"""A measure that a spec may name."""
