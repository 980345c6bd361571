"""Fixed obstacles in the box: posts, walls and patterns of solid cells."""

from typing import Annotated, Literal, Self, TypeVar

import numpy as np
from pydantic import Field, Tag, model_validator

from .base import Part, field, name_in, one_of

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

    @classmethod
    def of_ink(cls, ink: np.ndarray) -> "Pattern":
        """Return the pattern of a picture's ink (row from the top, column), 0 to 1, as
        `spec.targets` reads it from files: cells with more than half are solid."""
        rows = "/".join("".join(row) for row in np.where(ink > 0.5, SOLID, "."))
        return cls(kind="pattern", rows=rows)

    @model_validator(mode="after")
    def refuse_ragged(self) -> Self:
        lengths = {len(row) for row in self.rows.split("/")}
        if len(lengths) > 1:
            raise ValueError(f"`rows` must have one length, got {sorted(lengths)}")
        return self

    def solid(self, size: Size) -> np.ndarray:
        """Return the mask (x, y): each cell takes the symbol under its middle."""
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
    found = np.zeros(size, bool)
    for one in obstacles:
        found |= one.solid(size)
    return found


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
    found = np.zeros(len(points), bool)
    for dx in reach:
        for dy in reach:
            cell = base + np.array([dx, dy])
            near = np.hypot(*(points - cell).T) < distance
            found |= near & solid[cell[:, 0] % solid.shape[0], cell[:, 1] % solid.shape[1]]
    return found


Scaled = TypeVar("Scaled", bound=Part)


def _scaled(part: Scaled, names: tuple[str, ...], factor: float) -> Scaled:
    return part.model_copy(update={name: factor * getattr(part, name) for name in names})


def _near(
    one: tuple[float, float], other: tuple[float, float], distance: float, size: Size
) -> np.ndarray:
    """Return the cells within a distance of a straight line, in a periodic box."""
    found = np.zeros(size, bool)
    along = np.subtract(other, one)
    low, high = np.minimum(one, other) - distance, np.maximum(one, other) + distance
    x, y = (np.arange(int(np.ceil(a)), int(b) + 1) for a, b in zip(low, high, strict=True))
    away = np.stack(np.meshgrid(x, y, indexing="ij"), -1) - np.array(one)
    share = np.clip(away @ along / max(float(along @ along), 1e-12), 0, 1)
    inside = np.hypot(*np.moveaxis(away - share[..., None] * along, -1, 0)) <= distance
    cells = np.nonzero(inside)
    found[x[cells[0]] % size[0], y[cells[1]] % size[1]] = True
    return found
