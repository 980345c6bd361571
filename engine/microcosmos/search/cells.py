"""Cells of an archive: a grid of bins, or nearest centroids."""

from collections.abc import Callable
from math import inf, prod

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import scipy
from jaxtyping import Array, Float, Int

from .. import exact
from ..bounds import refuse_beyond, refuse_uncountable
from ..invalid import InvalidField
from ..measures import refuse_empty_axis

Measures = Float[Array, "row measure"]
Places = Float[Array, "row axis"]

MAX_LISTED = 2**22
"""Largest number of listed candidates; beyond it every centroid is compared."""


class Axis(eqx.Module):
    """One descriptor; `measure` is its column among the measures, `bins` are a grid's.

    Raises `InvalidField` for ends that are not finite or not in order, for a logarithmic axis
    from 0 or below, and without bins.
    """

    measure: int = eqx.field(static=True)
    low: float = eqx.field(static=True)
    high: float = eqx.field(static=True)
    bins: int = eqx.field(static=True)
    logarithmic: bool = eqx.field(static=True, default=False)

    def __check_init__(self) -> None:
        refuse_uncountable(0, measure=self.measure)
        refuse_uncountable(1, bins=self.bins)
        refuse_beyond(-inf, low=self.low, high=self.high)
        scale = "log10" if self.logarithmic else "linear"
        refuse_empty_axis(float(self.low), float(self.high), scale, self.bins)

    def place(self, value: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
        """Map values to 0 to 1 on the axis' own scale, clipped at the ends."""
        low, high = self.low, self.high
        value = jnp.clip(value, low, high)
        if self.logarithmic:
            low, high = (exact.logarithm(end) / exact.LN_10 for end in (low, high))
            value = jnp.log10(value)
        return (value - low) / (high - low)

    def value(self, place: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
        """Return the value at a place from 0 to 1, clipped at the ends."""
        place = jnp.clip(place, 0.0, 1.0)
        if not self.logarithmic:
            return self.low + place * (self.high - self.low)
        low, high = exact.logarithm(self.low), exact.logarithm(self.high)
        return jnp.exp(low + place * (high - low))

    @property
    def span(self) -> float:
        """Length of the axis, on a log axis that of the natural logarithm."""
        if not self.logarithmic:
            return self.high - self.low
        return float(exact.logarithm(self.high) - exact.logarithm(self.low))

    def bin(self, value: Float[Array, "*batch"]) -> Int[Array, "*batch"]:
        """Return numbers of half-open bins; values beyond an end are in the outer bin."""
        # The host computes the edges in double precision, and a value on an edge is in the
        # upper bin: so on every device.
        return jnp.searchsorted(self.edges, value, side="right").astype(jnp.int32)

    @property
    def edges(self) -> Float[np.ndarray, "edge"]:
        """The inner edges of the bins."""
        return exact.edges(self.low, self.high, self.bins, logarithmic=self.logarithmic)


class Grid(eqx.Module):
    """Cells in C order, the last descriptor fastest."""

    axes: tuple[Axis, ...]

    def __check_init__(self) -> None:
        _refuse_no_axes(self.axes)
        most = np.iinfo(np.int32).max  # The type of the numbers of cells.
        if self.count > most:
            raise InvalidField("axes", f"must have at most {most} cells; got {self.count}")

    @property
    def count(self) -> int:
        return prod(int(axis.bins) for axis in self.axes)

    @property
    def centres(self) -> Float[np.ndarray, "cell axis"]:
        """Centres of the cells, from 0 to 1 on the axes' own scales."""
        ticks = [(np.arange(axis.bins) + 0.5) / axis.bins for axis in self.axes]
        mesh = np.meshgrid(*ticks, indexing="ij")
        return np.stack([x.ravel() for x in mesh], 1).astype(np.float32)

    def of(self, measures: Measures) -> Int[Array, "row"]:
        """Return the number of each row's cell."""
        cell = jnp.zeros(measures.shape[0], jnp.int32)
        for axis in self.axes:
            cell = cell * axis.bins + axis.bin(measures[:, axis.measure])
        return cell


class Voronoi(eqx.Module):
    """Cells of the nearest centroid, the first of equally near ones.

    Places are from 0 to 1 on the axes' own scales. `near` lists, for every box of a coarse
    grid, the few centroids that can be nearest; None: all are compared.
    """

    axes: tuple[Axis, ...]
    centroids: Float[Array, "cell axis"]
    near: Int[Array, "box candidate"] | None

    @property
    def count(self) -> int:
        return self.centroids.shape[0]

    @property
    def centres(self) -> Float[np.ndarray, "cell axis"]:
        return np.asarray(self.centroids)

    def of(self, measures: Measures) -> Int[Array, "row"]:
        """Return the number of each row's cell."""
        place = places(measures, self.axes)
        if self.near is None:
            return _nearest(place, lambda axis: self.centroids[None, :, axis])
        # QDax compares all centroids: 95 ms for 1,024 rows and 16,384 cells, here 1 ms
        # (docs/evolution.md, "Cost compared with other libraries").
        side = boxes(self.count, len(self.axes))
        box = jnp.zeros(measures.shape[0], jnp.int32)
        for axis in range(len(self.axes)):
            step = jnp.clip(jnp.floor(place[:, axis] * side), 0, side - 1)
            box = box * side + step.astype(jnp.int32)
        listed = self.near[box]
        chosen = _nearest(place, lambda axis: self.centroids[:, axis][listed])
        return jnp.take_along_axis(listed, chosen[:, None], 1)[:, 0]


Cells = Grid | Voronoi


def voronoi(axes: tuple[Axis, ...], centroids: Float[np.ndarray, "cell axis"]) -> Voronoi:
    """Build cells around centroids. Raises `ValueError` if they do not fit the axes."""
    _refuse_no_axes(axes)
    centroids = np.asarray(centroids, np.float32)
    if centroids.ndim != 2 or centroids.shape[1] != len(axes) or len(centroids) < 2:
        raise ValueError(
            f"`centroids` must be at least 2 rows of {len(axes)}, got shape {centroids.shape}"
        )
    if not np.all((centroids >= 0) & (centroids <= 1)):
        raise ValueError("`centroids` must be from 0 to 1, got others")
    near = candidates(centroids)
    return Voronoi(axes, jnp.asarray(centroids), None if near is None else jnp.asarray(near))


def _refuse_no_axes(axes: tuple[Axis, ...]) -> None:
    if not axes:
        raise InvalidField("axes", "must hold at least one; got none")


def places(measures: Measures, axes: tuple[Axis, ...]) -> Places:
    """Return descriptors from 0 to 1 on the axes' own scales."""
    return jnp.stack([axis.place(measures[:, axis.measure]) for axis in axes], 1)


def boxes(cells: int, axes: int) -> int:
    """Return the boxes along each axis of the coarse grid; about one box per centroid."""
    # The root of a whole power may round to just below it.
    return max(1, int(cells ** (1 / axes) + 1e-9))


def candidates(centroids: np.ndarray) -> np.ndarray | None:
    """Return the centroids that can be nearest to a place in each box, padded with the last.

    None if the lists would be too long. From the middle m of a box with half diagonal h, no
    nearest centroid of a place in it is farther than |m − c| + 2 h, c being nearest to m.
    """
    cells, axes = centroids.shape
    side = boxes(cells, axes)
    middles = np.stack(np.meshgrid(*[(np.arange(side) + 0.5) / side] * axes, indexing="ij"), -1)
    middles, half = middles.reshape(-1, axes), np.sqrt(axes) / 2 / side
    tree = scipy.spatial.KDTree(centroids.astype(np.float64))
    reach = tree.query(middles)[0] + 2 * half + 1e-4  # A margin above the rounding of float32.
    counts = tree.query_ball_point(middles, reach, return_length=True)
    if len(middles) * counts.max() > MAX_LISTED:
        return None
    lists = tree.query_ball_point(middles, reach, return_sorted=True)
    flat = np.concatenate([np.asarray(one, np.int32) for one in lists])
    last = np.cumsum(counts) - 1
    column = np.arange(counts.max())[None]
    return flat[np.minimum((last - counts + 1)[:, None] + column, last[:, None])]


def _nearest(place: Places, of_axis: Callable[[int], Array]) -> Int[Array, "row"]:
    """Return the index of the nearest candidate to each place, the first of equal ones."""
    # Axis by axis: XLA on a CPU is slow where it reduces a short axis, and the order of the sum
    # must not depend on the processor.
    squares = [(place[:, i, None] - of_axis(i)) ** 2 for i in range(place.shape[1])]
    return jnp.argmin(sum(squares[1:], squares[0]), 1).astype(jnp.int32)
