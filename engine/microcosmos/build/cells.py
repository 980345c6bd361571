"""From the words for an archive to its cells."""

from .. import search, spec


def build_cells(
    archive: spec.Archive, measures: tuple[str, ...] = search.MEASURES
) -> search.Cells:
    """The archive's cells over recorded measures."""
    axes = build_axes(archive, measures)
    if archive.centroids is None:
        return search.Grid(axes)
    found = search.cvt.centroids(archive.centroids, len(axes), archive.seed)
    return search.voronoi(axes, found)


def build_axes(
    archive: spec.Archive, measures: tuple[str, ...] = search.MEASURES
) -> tuple[search.Axis, ...]:
    """The archive's descriptors among recorded measures."""
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
