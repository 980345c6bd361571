"""The box of fluid, its obstacles, flow and scalar fields, in lattice units (dx = dt = 1)."""

from math import ceil, sqrt
from typing import Annotated, ClassVar, Literal, Self, TypeVar

import numpy as np
from pydantic import Field, Tag, model_validator

from ..invalid import InvalidField
from .base import (
    LATTICE,
    OURS,
    PAPER,
    TRT,
    Part,
    field,
    name_in,
    one_of,
    refuse,
    sourced,
)


class Flow(Part):
    """A steady flow that a body force keeps up; the fluid starts in it."""

    model_config = sourced(OURS)

    kind: Literal["poiseuille", "shear", "vortices"] = "poiseuille"
    """Poiseuille flow along x between walls at y = 0; shear, a sine wave u = speed ·
    sin(2π y / height) along x, whose shear is strongest in the middle; or an array of vortices
    that turn against each other, one of which has its centre in the middle."""
    speed: float = field(0.01, gt=0.0, le=0.05, unit="cells/step")
    """Largest speed of the flow: in the middle of the channel, at the crests of the wave, or at
    the rims of the vortices."""
    vortices: int = field(2, ge=2, le=64, multiple_of=2)
    """Vortices along each side of the box."""


class Copies(Part):
    """Copies of the creature, which beat in step in one fluid."""

    model_config = sourced(OURS)

    count: int = field(2, ge=1, le=16, unit="creatures")
    """Number of copies, the creature included."""
    arrangement: Literal["row", "column", "grid"] = "column"
    """Places at the start, about the middle of the box: one behind the other along x (row),
    side by side along y (column), or both, with as many columns as rows or one more (grid)."""
    spacing: float = field(16.0, ge=2.0, le=1024.0, unit="cells")
    """Distance between neighbouring places."""

    @property
    def shape(self) -> tuple[int, int]:
        """Return the places along x and along y."""
        if self.arrangement == "grid":
            columns = ceil(sqrt(self.count))
            return columns, ceil(self.count / columns)
        return (self.count, 1) if self.arrangement == "row" else (1, self.count)

    @property
    def places(self) -> np.ndarray:
        """Return the places (copy, 2) about their mean, in cells."""
        number = np.arange(self.count)
        columns = self.shape[0]
        offsets = self.spacing * np.stack([number % columns, number // columns], 1)
        return offsets - offsets.mean(0)


SOLID = "#"

Size = tuple[int, int]


class Post(Part):
    """A disc."""

    kind: Literal["post"] = "post"
    x: float = field(..., ge=0.0, le=2048.0, unit="cells")
    """Middle of the disc along the box's width."""
    y: float = field(..., ge=0.0, le=2048.0, unit="cells")
    """Middle of the disc along the box's height."""
    radius: float = field(3.0, ge=1.0, le=512.0, unit="cells")
    """Radius of the disc."""
    ENDS: ClassVar = {"x": "width", "y": "height"}

    def solid(self, size: Size) -> np.ndarray:
        """Return the mask (x, y) of the cells whose middles are in the disc."""
        return _near((self.x, self.y), (self.x, self.y), self.radius, size)

    def scaled(self, factor: float) -> "Post":
        """Return the disc in a box whose sides are `factor` times as long."""
        return _scaled(self, ("x", "y", "radius"), factor)


class Wall(Part):
    """A straight wall with round ends."""

    kind: Literal["wall"]
    x0: float = field(..., ge=0.0, le=2048.0, unit="cells")
    """First end of the wall's middle line, along the box's width."""
    y0: float = field(..., ge=0.0, le=2048.0, unit="cells")
    """First end of the wall's middle line, along the box's height."""
    x1: float = field(..., ge=0.0, le=2048.0, unit="cells")
    """Second end of the wall's middle line, along the box's width."""
    y1: float = field(..., ge=0.0, le=2048.0, unit="cells")
    """Second end of the wall's middle line, along the box's height."""
    thickness: float = field(3.0, ge=2.0, le=512.0, unit="cells")
    """Thickness of the wall."""
    ENDS: ClassVar = {"x0": "width", "x1": "width", "y0": "height", "y1": "height"}

    def solid(self, size: Size) -> np.ndarray:
        """Return the mask (x, y) of the cells whose middles are in the wall."""
        return _near((self.x0, self.y0), (self.x1, self.y1), self.thickness / 2, size)

    def scaled(self, factor: float) -> "Wall":
        """Return the wall in a box whose sides are `factor` times as long."""
        return _scaled(self, ("x0", "y0", "x1", "y1", "thickness"), factor)


class Pattern(Part):
    """A pattern of solid cells, stretched to the whole box."""

    kind: Literal["pattern"]
    rows: str = Field(pattern=r"^[#.]+(/[#.]+)*$", max_length=2**22)
    """Rows from the top, divided by slashes and all of one length: # is solid, a full stop is
    fluid, as in ..#../.###."""
    ENDS: ClassVar[dict[str, str]] = {}

    @classmethod
    def of_ink(cls, ink: np.ndarray) -> "Pattern":
        """Return the pattern of a picture's ink (row from the top, column), 0 to 1, as
        `spec.targets` reads it from files: cells with more than half are solid."""
        rows = "/".join("".join(row) for row in np.where(ink > 0.5, SOLID, "."))
        return cls(kind="pattern", rows=rows)

    @model_validator(mode="after")
    def refuse_ragged(self) -> Self:
        lengths = {len(row) for row in self.rows.split("/")}
        refuse(len(lengths) > 1, "rows", f"must have one length, got {sorted(lengths)}")
        return self

    def solid(self, size: Size) -> np.ndarray:
        """Return the mask (x, y): each cell takes the symbol under its middle."""
        # Rows are from the top, y runs upwards.
        symbols = np.array([list(row) for row in self.rows.split("/")])[::-1] == SOLID
        x, y = ((np.arange(n) * m) // n for n, m in zip(size, symbols.shape[::-1], strict=True))
        return symbols[y[None, :], x[:, None]]

    def scaled(self, factor: float) -> "Pattern":
        """Return the pattern itself, which fills a box of any size."""
        return self


Obstacle = Annotated[
    Annotated[Post, Tag("post")]
    | Annotated[Wall, Tag("wall")]
    | Annotated[Pattern, Tag("pattern")],
    *one_of("kind", ("post", "wall", "pattern"), name_in("kind", "post")),
]


def solid_cells(obstacles: tuple[Post | Wall | Pattern, ...], size: Size) -> np.ndarray:
    """Return the mask (x, y) of the cells of all obstacles."""
    mask = np.zeros(size, bool)
    for one in obstacles:
        mask |= one.solid(size)
    return mask


def solid_runs(solid: np.ndarray) -> list[int]:
    """Return the lengths of runs of cells of fluid, of solid, of fluid and so on."""
    flat = solid.ravel()
    changes = np.flatnonzero(np.diff(flat)) + 1
    runs = np.diff(np.concatenate([[0], changes, [len(flat)]])).tolist()
    return [0, *runs] if flat[0] else runs


def crowded(points: np.ndarray, solid: np.ndarray, distance: int) -> np.ndarray:
    """Return the mask of points (point, 2) that have a solid cell's middle closer than this."""
    reach = np.arange(-distance, distance + 2)
    base = np.floor(points).astype(int)
    mask = np.zeros(len(points), bool)
    for dx in reach:
        for dy in reach:
            cell = base + np.array([dx, dy])
            near = np.hypot(*(points - cell).T) < distance
            mask |= near & solid[cell[:, 0] % solid.shape[0], cell[:, 1] % solid.shape[1]]
    return mask


Scaled = TypeVar("Scaled", bound=Part)


def _scaled(part: Scaled, names: tuple[str, ...], factor: float) -> Scaled:
    return part.model_copy(update={name: factor * getattr(part, name) for name in names})


def _near(
    one: tuple[float, float], other: tuple[float, float], distance: float, size: Size
) -> np.ndarray:
    """Return the cells within a distance of a straight line, in a periodic box."""
    mask = np.zeros(size, bool)
    along = np.subtract(other, one)
    low, high = np.minimum(one, other) - distance, np.maximum(one, other) + distance
    x, y = (np.arange(int(np.ceil(a)), int(b) + 1) for a, b in zip(low, high, strict=True))
    away = np.stack(np.meshgrid(x, y, indexing="ij"), -1) - np.array(one)
    share = np.clip(away @ along / max(float(along @ along), 1e-12), 0, 1)
    inside = np.hypot(*np.moveaxis(away - share[..., None] * along, -1, 0)) <= distance
    cells = np.nonzero(inside)
    mask[x[cells[0]] % size[0], y[cells[1]] % size[1]] = True
    return mask


class Steric(Part):
    """Repulsion between nodes by the gradient of their smoothed density."""

    model_config = sourced(PAPER)

    strength: float = field(4.0, gt=0.0, le=20.0, unit="cells³")
    """Displacement per step and unit of the density's gradient."""
    limit: float = field(0.1, gt=0.0, le=0.5, unit="cells/step")
    """Limit of a node's displacement by repulsion."""
    smoothing: Literal["gaussian", "binomial"] = "gaussian"
    """Gaussian by Fourier transform (the paper), or a binomial stencil of the same width."""


class Energy(Part):
    """Gaussian packets of energy at random places, to be sensed and collected."""

    model_config = sourced(PAPER)

    packets: int = field(8, ge=1, le=4096)
    """Number of packets."""
    width: float = field(4.0, ge=1.0, le=64.0, unit="cells")
    """Standard deviation of a packet."""
    # Of less, creatures collect up to 10,000 times as much: nothing, whatever its weight.
    amplitude: float = field(1.0, ge=1e-12, le=1e3, unit="energy/cell²")
    """Energy density in the middle of a packet."""
    seed: int = field(0, ge=0, lt=2**32)
    """Random seed of the packets' places, which are the same for every creature."""
    # Of more than 32 terms XLA makes a sum of sums, and the page would verify other bits.
    placements: int = field(1, ge=1, le=32)
    """Worlds per creature, each with the packets moved; measures are means over them. With
    several, a memorised path does not help; only sensing does."""
    consume: bool = field(False, source=OURS)
    """Remove collected energy; otherwise the field is persistent, as in the paper."""
    rate: float = field(0.1, gt=0.0, le=1.0)
    """Share of the energy around a node that it takes per step, if energy is consumed."""
    diffusion: float = field(0.0, ge=0.0, le=0.25, unit="cells²/step")
    """Diffusion coefficient of the energy; 0: none."""

    @model_validator(mode="after")
    def refuse_faint(self) -> Self:
        refuse(
            self.consume and self.rate * self.amplitude < 1e-6,
            "amplitude",
            "must be 1e-6 or more times `rate`, or float32 loses what is collected; got "
            f"{self.rate * self.amplitude}",
        )
        return self


VORTEX_CELLS = 8
"""Fewest cells along each side of a vortex. After 2,000 steps at ν from 0.01 to 2 the flow is
within 2.5 % (relative L2) of its closed form with 8 cells, 10 % with 4 and 37 % with 2."""
MAX_SOLID = 0.75
"""Largest share of the box that obstacles may fill."""


class World(Part):
    """A periodic box of fluid."""

    model_config = sourced(LATTICE)

    width: int = field(48, ge=16, le=2048, unit="cells")
    """Width of the box (x)."""
    height: int = field(48, ge=16, le=2048, unit="cells")
    """Height of the box (y)."""
    viscosity: float = field(0.05, ge=1e-3, le=2.0, unit="cells²/step")
    """Kinematic viscosity ν; the relaxation time is τ = 3 ν + 1/2."""
    magic: Literal["capped", "fixed"] = field("capped", source=TRT)
    """Magic parameter Λ of the two relaxation times: 3/16 (fixed), or at most (τ − 1/2)/2."""
    fluid: bool = True
    """Simulate the fluid; without it, only constraints and repulsion move bodies."""
    steric: Steric | None = None
    """Repulsion between nodes; empty: filaments pass through each other."""
    energy: Energy | None = None
    """Packets of energy; empty: none."""
    obstacles: tuple[Obstacle, ...] = field((), max_length=64, source=OURS)
    """Fixed obstacles, which hold the fluid at rest on their surface and keep bodies out;
    empty: none."""
    flow: Flow | None = None
    """A flow that the creature swims in; empty: the fluid starts at rest."""
    copies: Copies | None = None
    """A school of copies of the creature; empty: it swims alone."""

    @property
    def open(self) -> bool:
        """True if all places and directions in the box are alike but for energy."""
        return not self.obstacles and self.flow is None

    @property
    def solid(self) -> np.ndarray | None:
        """Return the mask (x, y) of cells without fluid; None: there are none."""
        walled = self.flow is not None and self.flow.kind == "poiseuille"
        if not self.obstacles and not walled:
            return None
        solid = solid_cells(self.obstacles, (self.width, self.height))
        # One row is enough: the box is periodic, so it is both walls of the channel.
        solid[:, 0] |= walled
        return solid

    @model_validator(mode="after")
    def check(self) -> Self:
        if (solid := self.solid) is not None and (share := solid.mean()) > MAX_SOLID:
            raise InvalidField(
                "obstacles",
                f"must leave at least {1 - MAX_SOLID:.0%} of the box to the fluid, "
                f"got {1 - share:.0%}",
            )
        refuse(
            self.flow is not None and not self.fluid,
            "flow",
            "must be empty where `fluid` is false; got one",
        )
        most = 2 * (min(self.width, self.height) // (2 * VORTEX_CELLS))
        refuse(
            self.flow is not None
            and self.flow.kind == "vortices"
            and self.flow.vortices > most,
            "flow.vortices",
            f"must be at most {most} in {self.width} × {self.height} cells, {VORTEX_CELLS} "
            f"cells for each; got {self.flow.vortices if self.flow else 0}",
            most=most,
        )
        for number, one in enumerate(self.obstacles):
            for name, side in one.ENDS.items():
                at, most = getattr(one, name), getattr(self, side)
                refuse(
                    at > most,
                    f"obstacles.{number}.{name}",
                    f"must be at most {most}, the {side} of the box; got {at:g}",
                    most=most,
                )
        refuse(
            self.magic == "fixed" and self.viscosity < 0.01,
            "magic",
            "must be 'capped' where `viscosity` is below 0.01, since a fixed magic "
            f"parameter is unstable there; got 'fixed' at {self.viscosity:g}",
        )
        return self
