"""The effective sperm number of a body: how fast its shape follows what is commanded."""

from math import isfinite, log1p

import numpy as np

from .. import units
from ..bodies import Body, is_exact
from ..bodies.relaxation import relaxation
from ..spec import GrownBody, Scene
from .physical import stroke_of


def sperm(scene: Scene, body: Body) -> float | None:
    """Return the effective sperm number of a body at rest in its scene; see `units.sperm`.

    The relaxation time is that in which the body's shape follows a command, the longer of that
    of its actuators and that of its slowest bend. None where a bend never relaxes. Raises
    `ValueError` for a controller without a stroke.
    """
    slowest = max(_response(getattr(scene.control, "lag", 0.0)), _bend(scene, body))
    period = stroke_of(scene)
    return units.sperm(period, slowest) if isfinite(slowest) else None


def _response(lag: float) -> float:
    """Return the steps in which the actuators' error falls to 1/e: a step leaves the share
    lag / (1 + lag) of it."""
    return 1 / log1p(1 / lag) if lag else 0.0


def _bend(scene: Scene, body: Body) -> float:
    """Return the steps in which the slowest bend falls to 1/e.

    Where a plan grew the body, a step leaves the share 1 − `bend` of each joint's error. Any
    other body has its rest shape at once, or is swept `constraint_iterations` times a step.
    """
    form, stiffness = scene.coupling, body.bend
    if isinstance(scene.body, GrownBody):
        softest = float(np.min(stiffness, initial=1.0))
        return 0.0 if softest == 1 else -1 / log1p(-softest)
    traits = getattr(scene.control, "traits", {})
    inherited = {"stretch", "shear", "bend"} & set(traits)
    if not inherited and is_exact(body, form.theta_feedback, form.nu_c):
        return 0.0
    if form.nu_c is not None:
        stiffness = stiffness / (1 + scene.world.viscosity / form.nu_c)
    return relaxation(body, stiffness) / form.constraint_iterations
