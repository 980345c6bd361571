"""Build the cells of an archive, or another container."""

from .. import search, spec
from ..archive.learned import floors
from ..spec import containers
from ..spec.measures import MEASURES


def build_container(
    archive: spec.Archive, measures: tuple[str, ...] = search.MEASURES
) -> search.Container:
    """Build the archive's container over recorded measures."""
    cells = build_cells(archive, measures)
    match archive.container:
        case containers.DominatedNovelty(size=size, neighbours=neighbours):
            return search.DominatedNovelty(cells, size, neighbours)
        case containers.Fronts(measure=name, goal=goal, size=size):
            usual = MEASURES[name]
            ends = usual.low, usual.high
            second = search.Axis(measures.index(name), *ends, 1, usual.scale == "log10")
            return search.Fronts(cells, second, size, goal == "least")
        case containers.LearnedAxes(axes=axes, bins=bins, first=first, measures=chosen):
            names = chosen or measures
            columns = tuple(measures.index(name) for name in names)
            given = {"axes": axes, "bins": bins, "first": first}
            return search.learned_axes(cells, columns, floors=floors(names), **given)
    return cells


def build_cells(
    archive: spec.Archive, measures: tuple[str, ...] = search.MEASURES
) -> search.Cells:
    """Build the archive's cells over recorded measures."""
    axes = build_axes(archive, measures)
    if archive.centroids is None:
        return search.Grid(axes)
    found = search.cvt.centroids(archive.centroids, len(axes), archive.seed)
    return search.voronoi(axes, found)


def build_axes(
    archive: spec.Archive, measures: tuple[str, ...] = search.MEASURES
) -> tuple[search.Axis, ...]:
    """Build the archive's axes over recorded measures."""
    return tuple(
        search.Axis(
            measure=measures.index(axis.name),
            low=axis.low,
            high=axis.high,
            bins=axis.bins,
            logarithmic=axis.scale == "log10",
        )
        for axis in archive.descriptors
    )
