"""What a known swimmer is: a body and the gait that its rest shape follows."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ... import bodies

Gait = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""From times in periods to deviations (time, joint) of rest angles in radians, and (time,
edge) of rest lengths as shares."""


@dataclass(frozen=True)
class Swimmer:
    """A body at rest, and how its rest shape deviates from that over time.

    The rest angle is `body.rest_angle + angle`, the rest length `body.rest_length * (1 +
    length)`. The gait repeats with every period and starts in full: what starts a body from
    rest multiplies it by a ramp.
    """

    name: str
    body: bodies.Body
    gait: Gait


def column(time: np.ndarray) -> np.ndarray:
    """Times as a column, to be broadcast over joints or edges."""
    return np.asarray(time, float)[:, None]


def still(time: np.ndarray, things: np.ndarray) -> np.ndarray:
    """No deviation of any of the joints or edges."""
    return np.zeros((len(time), len(things)))
