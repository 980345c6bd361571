"""The spec of filaments that fold into pictures, and its presets."""

from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Discriminator, Field, Tag, model_validator

from . import reverse
from .base import Part, unit
from .body import Body, Walk, made_elsewhere, resolved
from .body import about as shape
from .coupling import Coupling
from .scene import Fold, Scene
from .search import Task
from .sources import ADAM, DIGITS, PAPER, after, source
from .targets import MOST, decoded, encoded
from .targets import digit as handwritten
from .world import World


class Digit(Part):
    """One of ten handwritten digits of 8 × 8 pixels."""

    model_config = after(DIGITS)

    kind: Literal["digit"] = "digit"
    digit: int = Field(ge=0, le=9)
    """Which."""

    @property
    def name(self) -> str:
        return str(self.digit)

    @property
    def ink(self) -> np.ndarray:
        """Rows from the top, 1 is ink."""
        return handwritten(self.digit)


class Picture(Part):
    """Any picture, as `microcosmos picture` packs one."""

    kind: Literal["picture"]
    name: str = Field(min_length=1, max_length=64)
    """What it is called."""
    width: int = Field(ge=1, le=MOST, json_schema_extra=unit("pixels"))
    """Pixels of a row."""
    height: int = Field(ge=1, le=MOST, json_schema_extra=unit("pixels"))
    """Rows."""
    pixels: str = Field(max_length=2 * MOST**2)
    """Base64 of one byte a pixel, row by row from the top; 255 is ink."""

    @property
    def ink(self) -> np.ndarray:
        """Rows from the top, 1 is ink."""
        return decoded(self.pixels, self.width, self.height)

    @model_validator(mode="after")
    def refuse_malformed(self) -> Self:
        try:
            ink = self.ink
        except ValueError as error:
            raise ValueError(f"`pixels` {error}") from error
        if not ink.any():
            raise ValueError("`pixels` must show something, got paper alone")
        return self


def picture(name: str, ink: np.ndarray) -> Picture:
    """A target of ink (row, column) from 0 to 1, rows from the top."""
    height, width = ink.shape
    pixels = encoded(ink)
    return Picture(kind="picture", name=name, width=width, height=height, pixels=pixels)


def _kind(value: Any) -> Any:
    """The tag of a target."""
    return (
        value.get("kind", "digit") if isinstance(value, dict) else getattr(value, "kind", None)
    )


Target = Annotated[
    Annotated[Digit, Tag("digit")] | Annotated[Picture, Tag("picture")],
    Discriminator(
        _kind,
        custom_error_type="unknown_picture",
        custom_error_message="`kind` must be one of digit, picture",
    ),
]
"""What to fold into."""


class Folding(Part):
    """A filament whose rest shape is learnt, by gradients through its life, from pictures."""

    experiment: Literal["folding"] = "folding"
    targets: Annotated[tuple[Target, ...], Field(min_length=1, max_length=64)] = tuple(
        Digit(digit=number) for number in range(10)
    )
    """The pictures; each has a filament of its own."""
    world: World = World(width=128, height=128, viscosity=1 / 6, fluid=False)
    """The lattice of the pictures, with a fluid in it or without."""
    body: Body = Walk(builder="walk")
    """The filament as it is before it learns."""
    coupling: Coupling = Coupling(
        projection="force", theta_feedback=0, forcing_iterations=2, constraint_iterations=4
    )
    control: Fold = Fold()
    steps: int = Field(
        default=250, ge=10, le=100_000, json_schema_extra=unit("steps") | source(PAPER)
    )
    """Steps of the simulation, at the end of which the density counts."""
    size: int = Field(default=80, ge=4, le=2048, json_schema_extra=unit("cells"))
    """The longer side of a picture, which lies in the middle of the world."""
    width: float = Field(default=1.5, ge=0.5, le=16.0, json_schema_extra=unit("cells"))
    """Standard deviation of the Gaussian that a node counts as."""
    density: Literal["saturated", "raw"] = Field(
        default="saturated", json_schema_extra=source(f"raw: {PAPER}; saturated: ours")
    )
    """1 − exp(−ρ), in which a node upon another changes little, or the sum ρ of Gaussians."""
    rate: float = Field(
        default=0.04, gt=0.0, le=10.0, json_schema_extra=source(f"{ADAM}; the value: {PAPER}")
    )
    """Adam's learning rate, for angles in rad and for lengths."""
    updates: int = Field(default=300, ge=1, le=1_000_000, json_schema_extra=source(PAPER))
    """Steps of Adam."""
    block: int = Field(default=1, ge=1, le=64, json_schema_extra=unit("filaments"))
    """Filaments updated by one call of the compiled program; results depend on its bits."""
    memory: float = Field(default=2.0, gt=0.0, le=1000.0, json_schema_extra=unit("GiB"))
    """What a block may occupy, of which every device has one: where keeping all steps for the
    gradient takes more, as few are kept as can be and the others are done twice. Results depend
    on its bits."""

    @model_validator(mode="after")
    def check(self) -> Self:
        if (longest := min(self.world.width, self.world.height)) < self.size:
            raise ValueError(
                f"`size` must be at most the world's shorter side of {longest}, got {self.size}"
            )
        if self.world.energy is not None:
            raise ValueError("`world.energy` must be empty: nothing counts but the picture")
        names = [target.name for target in self.targets]
        if len(set(names)) < len(names):
            raise ValueError(f"`targets` must have names that differ, got {names}")
        if min(len(shape(self.body).joints), len(shape(self.body).edges)) < 1:
            raise ValueError("`body` must have a joint")
        if (needed := self.gradient_bytes / 2**30) > self.memory:
            raise ValueError(
                f"`memory` must be at least {needed:.3g} GiB for the gradient through "
                f"{self.steps} steps, got {self.memory:g}"
            )
        return self

    @property
    def step_bytes(self) -> int:
        """What reverse mode keeps of a step of a block."""
        nodes = len(shape(self.body).positions)
        return self.block * reverse.of_step(self.world, self.coupling, nodes)

    @property
    def state_bytes(self) -> int:
        """What reverse mode keeps of a state of a block."""
        return self.block * reverse.of_state(self.world, len(shape(self.body).positions))

    @property
    def segment(self) -> int | None:
        """Steps that are kept at a time, none where all fit into `memory`."""
        if self.steps * self.step_bytes <= self.memory * 2**30:
            return None
        return reverse.shortest(self.steps, self.step_bytes, self.state_bytes)

    @property
    def gradient_bytes(self) -> int:
        """What reverse mode keeps in all."""
        return reverse.in_all(self.steps, self.segment, self.step_bytes, self.state_bytes)

    @property
    def generations(self) -> int:
        """An update of all filaments is one."""
        return self.updates

    @property
    def scene(self) -> Scene:
        """What is simulated of each filament."""
        return Scene(
            world=self.world,
            body=self.body if made_elsewhere(self.body) else resolved(self.body),
            coupling=self.coupling,
            control=self.control,
            task=Task(steps=self.steps),
        )


LITERAL = {
    "coupling": Coupling(
        projection="none",
        theta_feedback=0,
        forcing_iterations=2,
        constraint_iterations=4,
        layers=2,
    ),
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
        Folding(
            targets=(Digit(digit=1), Digit(digit=3)),
            world=World(width=128, height=128, viscosity=1 / 6),
        ),
    ),
    "paper": (
        "As in the paper: in a fluid, density that does not saturate, lengths as they are",
        Folding(world=World(width=128, height=128, viscosity=1 / 6), **LITERAL),
    ),
}
