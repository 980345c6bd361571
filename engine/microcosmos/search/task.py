"""Tasks of creatures: a world, a body at its start, and a goal."""

import equinox as eqx
from jaxtyping import Array, Float, Int

from ..filaments import Rest
from ..genomes import Actuators, Encoding, Genotype
from ..measures import FORMS
from ..world import State, World
from .measures import MEASURES, Measure

Actuator = Genotype | Rest
"""A genotype, or rest shapes over time."""


class Goal(eqx.Module):
    """Weights of displacement and collected energy in fitness."""

    displacement: float = eqx.field(static=True, default=1.0)
    energy: float = eqx.field(static=True, default=0.0)
    measure: str | None = eqx.field(static=True, default=None)
    """Name of the measure that replaces both terms; None: displacement and energy."""
    sign: float = eqx.field(static=True, default=1.0)
    """−1: the smaller the measure, the fitter the creature."""


class Task(eqx.Module):
    """A world with a body at its start, the encoding of genotypes, and the goal."""

    world: World
    start: State
    encoding: Encoding | None = eqx.field(static=True, default=None)
    goal: Goal = Goal()
    length: float = eqx.field(static=True, default=1.0)
    """Length of the body in cells, for the Reynolds number."""
    period: float | None = eqx.field(static=True, default=None)
    """Steps of the controller's clock in a stroke; None: it has no strokes."""
    phase: Float[Array, ""] | None = None
    """Lead of a periodic timer, in rad."""
    turn: Float[Array, ""] | None = None
    """Turn of the body about its middle at the start, in rad."""
    trials: int = eqx.field(static=True, default=1)
    """Simulations of each creature, which differ in heading and phase."""
    placements: Int[Array, "placement 2"] | None = None
    """Shift of the energy, in cells, in each world that a creature is measured in; None: one
    world, unshifted."""
    form: tuple[float, ...] = eqx.field(static=True, default=(0.0,) * len(FORMS))
    """Measures of the form of a body whose shape is not inherited."""
    actuators: Actuators | None = None
    """Bounds on what the controllers of genotypes command; None: none."""
    places: Float[Array, "copy 2"] | None = None
    """Places of copies of the creature about the start, in cells; None: it is alone."""
    named_measures: tuple[Measure, ...] = eqx.field(static=True, default=())
    """Measures that the spec names, built in or of plug-ins, beside the usual ones."""

    @property
    def copies(self) -> int:
        """Return the number of creatures in the world."""
        return 1 if self.places is None else len(self.places)

    @property
    def measures(self) -> tuple[str, ...]:
        """Names of the measures of every creature, in this order."""
        return MEASURES + tuple(measure.name for measure in self.named_measures)
