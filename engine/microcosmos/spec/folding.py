"""The spec of filaments that fold into pictures, and its presets."""

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, Tag, model_validator

from ..invalid import InvalidField
from . import reverse
from .base import ADAM, DIGITS, PAPER, Part, enough, field, name_in, one_of, refuse, sourced
from .body import Body, GrownBody, Walk, estimated_shape, is_unavailable, resolved
from .coupling import Coupling
from .scene import Fold, Scene
from .search import Task
from .targets import MAX_PIXELS, decoded, encoded
from .targets import digit as handwritten
from .world import World


class Digit(Part):
    """One of ten handwritten digits of 8 × 8 pixels."""

    model_config = sourced(DIGITS)

    kind: Literal["digit"] = "digit"
    digit: int = Field(ge=0, le=9)
    """The digit."""

    @property
    def name(self) -> str:
        return str(self.digit)

    @property
    def ink(self) -> np.ndarray:
        """Return the pixels (row, column) from the top; 1 is ink."""
        return handwritten(self.digit)


class Picture(Part):
    """A picture packed by `microcosmos picture`."""

    kind: Literal["picture"]
    name: str = Field(min_length=1, max_length=64)
    """Name of the picture."""
    width: int = field(..., ge=1, le=MAX_PIXELS, unit="pixels")
    """Pixels per row."""
    height: int = field(..., ge=1, le=MAX_PIXELS, unit="pixels")
    """Number of rows."""
    pixels: str = Field(max_length=2 * MAX_PIXELS**2)
    """Base64 of one byte per pixel, row by row from the top; 255 is ink."""

    @property
    def ink(self) -> np.ndarray:
        """Return the pixels (row, column) from the top; 1 is ink."""
        return decoded(self.pixels, self.width, self.height)

    @model_validator(mode="after")
    def refuse_malformed(self) -> Self:
        try:
            ink = self.ink
        except ValueError as error:
            raise InvalidField("pixels", str(error)) from error
        refuse(not ink.any(), "pixels", "must show something, got a blank picture")
        return self


def picture(name: str, ink: np.ndarray) -> Picture:
    """Return the target with this ink: (row, column) from the top, 0 to 1."""
    height, width = ink.shape
    pixels = encoded(ink)
    return Picture(kind="picture", name=name, width=width, height=height, pixels=pixels)


Target = Annotated[
    Annotated[Digit, Tag("digit")] | Annotated[Picture, Tag("picture")],
    *one_of("kind", ("digit", "picture"), name_in("kind", "digit")),
]


# Edge angles that follow the geometry keep a filament from folding: after 60 updates the loss
# was 0.125 instead of 0.022.
FORCED = Coupling(
    projection="force", theta_feedback=0, forcing_iterations=2, constraint_iterations=4
)
VISCOUS = World(width=128, height=128, viscosity=1 / 6)


class Folding(Part):
    """Filaments that learn, by gradients through the simulation, to fold into pictures."""

    experiment: Literal["folding"] = "folding"
    targets: Annotated[tuple[Target, ...], Field(min_length=1, max_length=64)] = tuple(
        Digit(digit=number) for number in range(10)
    )
    """Target pictures, one filament each."""
    world: World = VISCOUS.model_copy(update={"fluid": False})
    """Lattice of the pictures, with or without fluid."""
    body: Body = Walk(builder="walk")
    """Initial filament."""
    coupling: Coupling = FORCED
    control: Fold = Fold()
    steps: int = field(250, ge=10, le=100_000, unit="steps", source=PAPER)
    """Steps of the simulation; the density at its end is compared with the picture."""
    size: int = field(80, ge=4, le=2048, unit="cells")
    """Longer side of a picture, which is centred in the world."""
    width: float = field(1.5, ge=0.5, le=16.0, unit="cells")
    """Standard deviation of a node's Gaussian in the density."""
    density: Literal["saturated", "raw"] = field(
        "saturated", source=f"raw: {PAPER}; saturated: ours"
    )
    """Density: the sum ρ of Gaussians (raw), or 1 − exp(−ρ), in which overlapping nodes add
    little (saturated)."""
    rate: float = field(0.04, gt=0.0, le=10.0, source=f"{ADAM}; the value: {PAPER}")
    """Adam's learning rate, for angles in rad and for lengths."""
    updates: int = field(300, ge=1, le=1_000_000, source=PAPER)
    """Steps of Adam."""
    block: int = field(1, ge=1, le=64, unit="filaments")
    """Filaments per call of the compiled program; the exact bits of results depend on it."""
    memory: float = field(2.0, gt=0.0, le=1000.0, unit="GiB")
    """Memory limit of a block, of which every device has one. Where the gradient needs more,
    some steps are recomputed; the exact bits of results depend on it."""

    @model_validator(mode="after")
    def check(self) -> Self:
        if (longest := min(self.world.width, self.world.height)) < self.size:
            raise InvalidField(
                "size",
                f"must be at most the world's shorter side of {longest}, got {self.size}",
                most=longest,
            )
        refuse(
            self.world.energy is not None,
            "world.energy",
            "must be empty: folding collects no energy",
        )
        refuse(
            not self.world.open or self.world.copies is not None,
            "world.obstacles",
            "must be empty, as `world.flow` and `world.copies`: a filament "
            "folds alone in an open box of fluid at rest",
        )
        names = [target.name for target in self.targets]
        refuse(
            len(set(names)) < len(names), "targets", f"must have different names, got {names}"
        )
        if isinstance(self.body, GrownBody):
            raise InvalidField("body", "must have a fixed graph to be folded, got 'grown'")
        refuse(not len(estimated_shape(self.body).joints), "body", "must have a joint")
        if (needed := self.gradient_bytes / 2**30) > self.memory:
            raise InvalidField(
                "memory",
                f"must be at least {enough(needed)} GiB for the gradient through "
                f"{self.steps} steps, got {self.memory:.12g}",
                least=float(enough(needed)),
            )
        return self

    @property
    def reverse_bytes(self) -> tuple[int, int]:
        """Return the bytes that reverse mode keeps per step and per state of a block."""
        nodes = len(estimated_shape(self.body).positions)
        step = reverse.step_bytes(self.world, self.coupling, nodes)
        return self.block * step, self.block * reverse.state_bytes(self.world, nodes)

    @property
    def segment(self) -> int | None:
        """Return the steps kept at a time, for the least memory; None if all fit."""
        step, state = self.reverse_bytes
        if self.steps * step <= self.memory * 2**30:
            return None
        # The states kept and the steps of one segment together are least there.
        return max(1, round((self.steps * state / step) ** 0.5))

    @property
    def gradient_bytes(self) -> int:
        """Return the bytes that reverse mode keeps in all."""
        return reverse.total_bytes(self.steps, self.segment, *self.reverse_bytes)

    @property
    def generations(self) -> int:
        """Return the updates, each of all filaments."""
        return self.updates

    @property
    def scene(self) -> Scene:
        """Return the scene of every filament."""
        return Scene(
            world=self.world,
            body=self.body if is_unavailable(self.body) else resolved(self.body),
            coupling=self.coupling,
            control=self.control,
            task=Task(steps=self.steps, fitness="displacement"),
        )


LITERAL = {
    "coupling": FORCED.model_copy(update={"projection": "none", "layers": 2}),
    "control": Fold(lengths="raw"),
    "density": "raw",
}

PRESETS = {
    "demo": (
        "A hundred nodes fold into two digits without a fluid, a minute on a laptop",
        Folding(
            targets=(Digit(digit=3), Digit(digit=7)),
            world=World(width=48, height=48, fluid=False),
            body=Walk(builder="walk", nodes=160, deviation=0.5),
            steps=100,
            size=32,
            width=1.0,
            updates=150,
        ),
    ),
    "digits": ("1,000 nodes fold into ten digits without a fluid", Folding()),
    "digits-fluid": (
        "1,000 nodes fold into two digits in a viscous fluid",
        Folding(targets=(Digit(digit=1), Digit(digit=3)), world=VISCOUS),
    ),
    "paper": (
        "As in the paper: in a fluid, density that does not saturate, lengths as they are",
        Folding(world=VISCOUS, **LITERAL),
    ),
}
