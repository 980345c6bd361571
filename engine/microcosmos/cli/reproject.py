"""The command `reproject`: a run's creatures as an archive over any other axes."""

import json as json_module
from collections.abc import Callable, Sequence
from dataclasses import asdict
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from typer import Argument, Option

from ..archive.atomic import write_whole
from ..archive.axes import Axis, of_spec
from ..archive.export import as_csv
from ..archive.file import load
from ..archive.population import Creatures, creatures, of_file
from ..archive.principal import NAME, Component
from ..archive.reprojection import COMPONENTS, FITNESS, Reprojection, over, reproject
from ..client import Client, Run
from ..viz.figures import maps
from .app import fail, failing, refuse_input, say
from .remote import RUNS, Json, connecting, server_command, show, show_table

PCA = "pca"
"""Short for the axes of the two largest principal components."""
STRONGEST = 6
"""Loadings of a component that are printed."""
ELITES, HISTORY = "present elites", "all that ever entered"


class Of(StrEnum):
    """The creatures to project."""

    history = "history"
    elites = "elites"


@server_command(RUNS, "reproject", make=connecting)
def project(
    connect: Callable[[], Client],
    source: Annotated[
        str,
        Argument(metavar="RUN_OR_FILE", help="Id of a run on a server, or an archive file."),
    ],
    axes: Annotated[
        str,
        Option(help="Measures as a,b; also fitness, and pc1, pc2 … or pca for components."),
    ] = PCA,
    bins: Annotated[
        str | None, Option(help="Bins of each axis, as 24 or 24,12; default: 24.")
    ] = None,
    of: Annotated[
        Of, Option(help="All creatures that ever entered the archive, or the present elites.")
    ] = Of.history,
    components_of: Annotated[
        str | None,
        Option(help="Measures that components are made of, as a,b; default: all."),
    ] = None,
    out: Annotated[
        Path | None, Option(help="Write the elites over the new axes as CSV.")
    ] = None,
    figure: Annotated[
        Path | None, Option(help="Draw the map: a .pdf, .svg or .png file.")
    ] = None,
    json: Json = False,
) -> None:
    """Re-project a run onto any measures or learned axes, without simulating anything.

    A creature that lost its cell can be the best of a cell of other axes. An axis of the
    archive itself keeps its ends and bins; any other has the ends of its measure.
    """
    refuse_input(out, Path(source))
    refuse_input(figure, Path(source), option="--figure")
    names = list(COMPONENTS) if axes == PCA else _names(axes)
    sizes = [_whole(text) for text in _names(bins)]
    of_these = _names(components_of)
    found, present, known, title = _read(connect, source, of, names, of_these)
    main, learned = over(found, names, known, sizes, of_these or None)
    shown = {HISTORY if present else ELITES: main}
    if present:
        shown = {ELITES: reproject(main.creatures.among(present), main.axes), **shown}
    _print(shown, learned, json)
    # After the figures: standard output is complete even if a file cannot be written.
    if out:
        write_whole(out, table(main).encode())
        say(f"{out}: {len(main.last):,} elites")
    if figure:
        for path in maps.draw_reprojections(figure, shown, learned, title):
            say(str(path))


Source = tuple[Creatures, list[str], dict[str, Axis], str]
"""Creatures, the present elites among them if they are fewer, the archive's axes, a title."""


def _read(
    connect: Callable[[], Client],
    source: str,
    of: Of,
    names: Sequence[str],
    components_of: Sequence[str],
) -> Source:
    """Read a file if there is one, else a run on the server."""
    file = Path(source)
    if file.is_file():
        return _of_file(file, of)
    learns = any(map(NAME.fullmatch, names))
    # Components are made of all measures, unless some are named; other axes need theirs alone.
    wanted = None if learns and not components_of else [*names, *components_of]
    return _of_run(connect().run(source), of, wanted)


def _of_file(file: Path, of: Of) -> Source:
    with failing(file):
        data = file.read_bytes()
        elites, attributes = of_file(data), load(data)[1]
        known = of_spec(json_module.loads(attributes["spec"]))
    if of is Of.history:
        say(
            f"{file} has the measures of its {len(elites):,} elites only, so replaced "
            "creatures are not projected. A run on a server has those of all that ever entered."
        )
    return elites, [], known, file.name


def _of_run(run: Run, of: Of, wanted: Sequence[str] | None) -> Source:
    archive = run.archive()
    known, title = of_spec(run.spec), f"run {run.id[:8]}"
    if of is Of.elites:
        columns = (archive.fitness, archive.elite_generation, archive.measures)
        return creatures(archive.creature, *columns), [], known, title
    names = [one["name"] for one in archive.recorded]
    if wanted is not None and set(wanted) <= {*names, FITNESS}:  # The error lists all.
        names = [name for name in names if name in wanted]
    history = run.history(names)
    measures = {name: history[name] for name in names}
    columns = (history["fitness"], history["generation"], measures)
    return creatures(list(history["creature"]), *columns), archive.creature, known, title


def table(one: Reprojection) -> str:
    """Return the elites as CSV, in the order of cells."""
    found, rows = one.creatures, one.elites
    bins = np.unravel_index(one.filled, [axis.bins for axis in one.axes])
    columns: dict[str, Any] = {"cell": one.filled}
    columns |= {f"bin_{axis.name}": b for axis, b in zip(one.axes, bins, strict=True)}
    columns |= {"creature": [name.decode() for name in found.names[rows]]}
    columns |= {"generation": found.generation[rows], FITNESS: found.fitness[rows]}
    columns |= {name: column[rows] for name, column in found.measures.items()}
    return as_csv(columns)


def _print(shown: dict[str, Reprojection], learned: Sequence[Component], as_json: bool) -> None:
    first = next(iter(shown.values()))
    figures = [
        {
            "of": name,
            "creatures": len(one.creatures),
            "elites": len(one.last),
            "coverage": one.coverage,
            "qd_score": one.qd_score,
            "best": one.best,
        }
        for name, one in shown.items()
    ]
    if as_json:
        axes = [asdict(axis) for axis in first.axes]
        components = [asdict(component) for component in learned]
        show({"axes": axes, "cells": first.count, "components": components, "of": figures})
        return
    for axis in first.axes:
        log = ", log" if axis.scale == "log10" else ""
        say(f"{axis.name}: {axis.low:g} to {axis.high:g}{log}, {axis.bins} bins")
    titles = ("of", "creatures", "elites", "coverage", "QD score", "best")
    show_table(titles, [_row(**one) for one in figures])
    for one in learned:
        strongest = list(one.loadings.items())[:STRONGEST]
        listed = ", ".join(f"{name} {loading:+.2f}" for name, loading in strongest)
        print(f"{one.name}  {one.explained:.1%} of the variance: {listed}")


def _row(of: str, creatures: int, elites: int, coverage: float, qd_score: float, best: Any):
    best = "–" if best is None else f"{best:.4g}"
    return of, f"{creatures:,}", f"{elites:,}", f"{coverage:.1%}", f"{qd_score:.4g}", best


def _names(text: str | None) -> list[str]:
    return [name.strip() for name in (text or "").split(",") if name.strip()]


def _whole(text: str) -> int:
    if not text.isdecimal():
        fail(f"--bins needs whole numbers such as 24 or 24,12; got {text}")
    return int(text)
