"""The process of one sink, with pictures of archives: `python -m microcosmos.viz.sink`."""

from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from ..sinks.process import main

DPI = 150


def picture(data: bytes) -> bytes | None:
    """Return a PNG of an archive file; None without elites, an archive, or matplotlib."""
    from .figures import drawing

    with TemporaryDirectory() as folder, suppress(ImportError, ValueError):
        path, out = Path(folder, "run.h5"), Path(folder, "archive.png")
        path.write_bytes(data)
        drawing.archive(path, out, drawing.Print(dpi=DPI), None, "fitness")
        return out.read_bytes()
    return None


if __name__ == "__main__":
    main(picture)
