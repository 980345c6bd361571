"""The process of one sink, with pictures of archives: `python -m microcosmos.viz.sink`."""

from contextlib import suppress

from ..sinks.process import main

DPI = 150


def picture(data: bytes) -> bytes | None:
    """Return a PNG of an archive file; None without elites, an archive, or matplotlib."""
    from .figures import drawing

    # The sink keeps its curves without matplotlib, and before the first elite.
    with suppress(ImportError, ValueError):
        return drawing.picture(data, drawing.Print(dpi=DPI))


if __name__ == "__main__":
    main(picture)
