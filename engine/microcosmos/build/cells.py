"""From the words for an archive to its cells."""

from .. import search, spec


def build_niches(
    archive: spec.Archive, features: tuple[str, ...] = search.FEATURES
) -> search.Cells:
    """The archive's cells over recorded features."""
    axes = build_axes(archive, features)
    if archive.centroids is None:
        return search.Grid(axes)
    found = search.cvt.centroids(archive.centroids, len(axes), archive.seed)
    return search.voronoi(axes, found)


def build_axes(
    archive: spec.Archive, features: tuple[str, ...] = search.FEATURES
) -> tuple[search.Axis, ...]:
    """The archive's descriptors among recorded features."""
    return tuple(
        search.Axis(
            feature=features.index(axis.name),
            low=axis.low,
            high=axis.high,
            bins=axis.bins,
            logarithmic=axis.scale == "log10",
        )
        for axis in archive.descriptors
    )
