"""The option --from: initial creatures from creature files and archives."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from typer import Option

from ..archive import creature_h5, initial
from ..archive.creature import parse
from ..spec import Evolution, Spec
from ..spec import parse as parse_spec
from ..viz.figures.reading import read
from .app import fail, failing

CreatureFile = dict[str, Any]

From = Annotated[
    list[Path] | None,
    Option(
        "--from",
        exists=True,
        dir_okay=False,
        help="Start from a creature file, or from all elites of an archive; repeatable.",
    ),
]


def with_initial(
    spec: Spec, paths: Sequence[Path], archive: Path
) -> tuple[Spec, list[CreatureFile]]:
    """Return the spec that names its initial creatures, and their files.

    A spec that already names creatures keeps them. Fail if one does not fit, or if its file is
    missing and there is no archive that holds it.
    """
    if not paths:
        count = len(spec.search.initial) if isinstance(spec, Evolution) else 0
        if count and not archive.exists():
            fail(f"`search.initial` names {count} creatures: --from needs the files with them")
        return spec, []
    if not isinstance(spec, Evolution):
        fail(f"--from needs a search's spec, got {spec.experiment}")
    found = {file["sha256"]: file for path in paths for file in creatures(path)}
    named = spec.search.initial or sorted(found)
    if lacking := [name for name in named if name not in found]:
        fail(
            f"--from needs the creatures that `search.initial` names; got none of {lacking[0]}"
        )
    with failing("--from"):
        search = {**spec.search.model_dump(mode="json"), "initial": named}
        chosen = parse_spec({**spec.model_dump(mode="json"), "search": search})
        assert isinstance(chosen, Evolution)
        files = [found[name] for name in named]
        initial.genes_of(chosen, files)
        return chosen, files


def creatures(path: Path) -> list[CreatureFile]:
    """Return the creatures of a creature file or an archive; fail for any other file."""
    with failing(f"--from needs a creature file or an archive; {path}"):
        data = path.read_bytes()
        if creature_h5.is_of_run(data):
            return _elites(data)
        return [creature_h5.read(data)]


def _elites(data: bytes) -> list[CreatureFile]:
    import jax

    from ..build import build

    found = read(data)
    experiment = build(found.spec)
    # Row by row they would be fetched from the device over and over.
    state = jax.device_get(experiment.restore(data, other_device=True))
    return [parse(experiment.creature(state, cell)) for cell in found.cells.tolist()]  # pyright: ignore
