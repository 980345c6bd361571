"""What a run begins from: creatures in files, as `search.initial` names them."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from pydantic import ValidationError

from ..archive import creature_h5, initial
from ..archive.creature import CreatureError, parse
from ..archive.file import HDF5, load
from ..plugins import Broken, Missing
from ..spec import Evolution, Spec
from ..spec import parse as parse_spec
from ..viz.figures.reading import read
from .app import fail
from .specs import said

CreatureFile = dict[str, Any]

From = Annotated[
    list[Path] | None,
    typer.Option(
        "--from",
        exists=True,
        dir_okay=False,
        help="Start from a creature file, or from all elites of an archive; repeatable.",
    ),
]


def begun(spec: Spec, paths: Sequence[Path]) -> tuple[Spec, list[CreatureFile]]:
    """The spec that names what it begins from, and the files of those creatures.

    A spec that names creatures already begins from those; it ends here where one does not fit.
    """
    if not paths:
        return spec, []
    if not isinstance(spec, Evolution):
        fail(f"--from needs a search's spec, got {spec.experiment}")
    found = {file["sha256"]: file for path in paths for file in creatures(path)}
    named = spec.search.initial or sorted(found)
    if lacking := [name for name in named if name not in found]:
        fail(
            f"--from needs the creatures that `search.initial` names; got none of {lacking[0]}"
        )
    try:
        search = {**spec.search.model_dump(mode="json"), "initial": named}
        chosen = parse_spec({**spec.model_dump(mode="json"), "search": search})
        assert isinstance(chosen, Evolution)
        files = [found[name] for name in named]
        initial.genes_of(chosen, files)
    except CreatureError as error:
        fail(f"--from: {error}")
    except ValidationError as error:
        fail("\n".join(f"--from: {said(one)}" for one in error.errors()))
    return chosen, files


def refuse_without_files(spec: Spec, files: Sequence[CreatureFile], archive: Path) -> None:
    """Fail if the files of the initial creatures are missing."""
    named = spec.search.initial if isinstance(spec, Evolution) else ()
    if named and not files and not archive.exists():
        fail(f"`search.initial` names {len(named)} creatures: --from needs the files with them")


def creatures(path: Path) -> list[CreatureFile]:
    """Return the creatures of a creature file or an archive; fail for any other file."""
    try:
        data = path.read_bytes()
        return _of_hdf5(data) if data.startswith(HDF5) else [parse(data)]
    except (ValueError, OSError, Missing, Broken) as error:
        fail(f"--from needs a creature file or an archive; {path}: {error}")


def _of_hdf5(data: bytes) -> list[CreatureFile]:
    try:
        load(data)
    except ValueError:  # It is no run's.
        return [creature_h5.load(data)]
    return _elites(data)


def _elites(data: bytes) -> list[CreatureFile]:
    import jax

    from ..build import build

    found = read(data)
    experiment = build(found.spec)
    # Row by row they would be fetched from the device over and over.
    state = jax.device_get(experiment.restore(data, other_device=True))
    return [parse(experiment.creature(state, cell)) for cell in found.cells.tolist()]  # pyright: ignore
