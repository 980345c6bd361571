"""The map of an archive: cells by fitness, creatures that swim, a selection for Python."""

import os
from threading import Lock, Timer
from typing import Any

from ..archive import poses
from ..archive.report import Report
from ..optional import require
from .assets import script, styles
from .contents import MOST, Contents, Read, empty, fittest, of_file

NOTEBOOK = "microcosmos[notebook]"
anywidget: Any = require("anywidget", NOTEBOOK)
traitlets: Any = require("traitlets", NOTEBOOK)

SECONDS, POSES_SECONDS = 1.0, 5.0
"""Shortest times between two updates of the map, and of its creatures, in seconds."""

Source = Any
"""A spec, an archive file or its path, an archive of a server, or a run of a server."""


class ArchiveMap(anywidget.AnyWidget):
    """The elites of an archive by cell, in the colour of their fitness.

    Point at a cell to read its elite's measures and see it swim over its last two strokes; a
    click selects the cell, a drag those in a box or in a loop. `selected` holds the cells in
    Python, and `observe` it as any trait. The motions are part of the widget, so they need no
    server: those of the 600 fittest elites.
    """

    x = traitlets.Unicode(None, allow_none=True).tag(sync=True)
    """Name of the measure across; None for the archive's first axis."""
    y = traitlets.Unicode(None, allow_none=True).tag(sync=True)
    """Name of the measure upwards; None for the archive's second axis."""
    colour = traitlets.Unicode("fitness").tag(sync=True)
    """Name of the measure of the colours, or `fitness`, or `age`."""
    selected = traitlets.List(traitlets.Int()).tag(sync=True)
    """Numbers of the selected cells."""
    status = traitlets.Unicode("").tag(sync=True)
    """A line below the map, such as the state of a run."""
    _esm = traitlets.Unicode().tag(sync=True)
    _css = traitlets.Unicode().tag(sync=True)
    _kind = traitlets.Unicode("map").tag(sync=True)
    _archive = traitlets.Dict().tag(sync=True)
    _poses = traitlets.Bytes(b"").tag(sync=True)
    _about = traitlets.Unicode("").tag(sync=True)

    def __init__(self, source: Source, **options: Any):
        """Show an archive; `options` are `x`, `y`, `colour` and `selected`.

        The map of a spec is empty: `mc.evolve(spec, path, tell=map.tell)` fills it. Where that
        goes on from a file, give the file: a generation brings its new elites alone. Raise
        `ValueError` for a file or a spec of a run without an archive.
        """
        self._lock = Lock()
        self._timer: Timer | None = None
        self._countdown = 0.0
        self._contents = contents_of(source)
        given = self._contents.document()
        super().__init__(
            _archive=given,
            _poses=self._motions(given),
            _about=about(given),
            _esm=script(),
            _css=styles(),
            **options,
        )

    def __repr__(self) -> str:
        return f"<ArchiveMap: {self._about}>"

    @property
    def creatures(self) -> list[str]:
        """Return the SHA-256 of each selected creature, in the order of `selected`."""
        names = dict(zip(self._archive["cell"], self._archive["creature"], strict=True))
        return [names[cell] for cell in self.selected if cell in names]

    def show(self, source: Source) -> None:
        """Show another state of the archive, or another archive; axes and colour stay."""
        with self._lock:
            self._contents = contents_of(source)
        self._draw(motions=True)

    def tell(self, report: Report) -> None:
        """Take the elites of a generation; for the `tell` of `microcosmos.evolve`.

        The map of a notebook follows within a second, its creatures within five.
        """
        if not isinstance(self._contents, Contents):
            raise ValueError("`tell` needs a map of a spec or of a file, got one of a server")
        with self._lock:
            self._contents.add(report)
            # Generations may come faster than a page draws: one timer gathers them.
            if self._timer is None:
                self._timer = Timer(SECONDS, self._tick)
                self._timer.daemon = True
                self._timer.start()

    def _tick(self) -> None:
        with self._lock:
            self._timer = None
            self._countdown -= SECONDS
            motions = self._countdown <= 0
            if motions:
                self._countdown = POSES_SECONDS
        self._draw(motions)

    def _draw(self, motions: bool) -> None:
        with self._lock:
            given = self._contents.document()
            batch = self._motions(given) if motions else self._poses
        # One message: the page must not draw cells of one state with motions of another.
        with self.hold_sync():
            self._archive, self._poses, self._about = given, batch, about(given)
            # Cells that were emptied are selected no longer
            # (test_a_selection_names_creatures_and_loses_cells_that_are_gone).
            present = set(given["cell"])
            self.selected = [cell for cell in self.selected if cell in present]

    def _motions(self, document: dict[str, Any]) -> bytes:
        streams = self._contents.pose_streams(fittest(document))
        return poses.batch(streams.values())


def contents_of(source: Source) -> Contents | Read:
    """Return the content of a map. Raise `ValueError` where there is no archive."""
    if isinstance(source, Read):
        return source
    if isinstance(source, bytes | str | os.PathLike):
        return of_file(source)
    if callable(getattr(source, "archive", None)):  # A run of a server.
        return source.archive()
    return empty(source)


def about(document: dict[str, Any]) -> str:
    """Return a line on the archive."""
    filled = document["cell"]
    words = "places" if document["kind"] == "pool" else "cells"
    parts = [f"{len(filled):,} of {document['cells']:,} {words}"]
    parts += [f"generation {document['generation']}"]
    if len(filled) > MOST:
        parts += [f"the {MOST} fittest swim"]
    return " · ".join(parts)
