"""The runs of a study: their identities, by which finished ones are found, and their locks."""

import fcntl
import hashlib
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from errno import ENOLCK, ENOSYS, ENOTSUP
from math import prod
from pathlib import Path
from typing import IO, Any

import rfc8785
from pydantic import ValidationError

from ..archive.file import load
from ..invalid import InvalidField
from ..json_text import read_json
from ..spec import Evolution, Spec, parse, paths
from ..spec.base import invalid_fields
from ..spec.experiments import presets
from .document import MAX_RUNS, Study, Sweep

SHORT = 12
"""Characters of an identity that name a run and its file."""


@dataclass(frozen=True, eq=False)
class PlannedRun:
    """A run of a sweep, and its file."""

    sweep: str
    values: dict[str, Any]
    """The case: values by paths of the grid, numbers and words as the spec has them."""
    given: dict[str, Any]
    """The same as the study's file has it, where a number may be text."""
    spec: Any
    path: Path

    @property
    def id(self) -> str:
        """Return the first characters of the SHA-256 of the spec as canonical JSON."""
        return self.path.stem

    def done(self) -> tuple[int, bool]:
        """Return the last generation in its file, 0 without one, and whether it is finished.

        Raises `ValueError`, which names the run, for a damaged file and one of another run.
        """
        if not self.path.exists():
            return 0, False
        with self.named():
            # Genomes and poses make up most of a file.
            tree, attributes = load(self.path.read_bytes(), only=("curves",))
            self.refuse_other(json.loads(attributes["spec"]))
            ended = json.loads(attributes["ended"])
            return len(tree["curves"]["evaluations"]), ended is not None

    def refuse_other(self, document: Mapping[str, Any]) -> None:
        """Raise `ValueError` for the spec of another run: a file may have been renamed."""
        if identity(parse(document))[:SHORT] != self.id:
            raise ValueError(
                f"the file {self.path} must be of this run, got one of another spec"
            )

    @contextmanager
    def named(self) -> Iterator[None]:
        """Name the run in errors, which become `ValueError`."""
        try:
            yield
        except (ValueError, OSError) as error:
            raise ValueError(f"run {self.id}: {error}") from error


@dataclass(frozen=True, eq=False)
class Plan:
    study: Study
    folder: Path
    """Folder of the runs, figures, exports and the report."""
    bases: dict[str, Spec]
    """The spec of each sweep before the grid, with the first seed."""
    runs: tuple[PlannedRun, ...]

    def unique(self) -> list[PlannedRun]:
        """Return each run once, also if several sweeps have it."""
        return list({run.id: run for run in reversed(self.runs)}.values())[::-1]

    def of(self, sweep: str, where: Mapping[str, Any]) -> list[PlannedRun]:
        """Return the runs of a sweep whose cases have some values. Raises `ValueError` where
        the grid has no such values."""
        matching = [
            run
            for run in self.runs
            if run.sweep == sweep
            and all(
                k in run.given and v in (run.values[k], run.given[k]) for k, v in where.items()
            )
        ]
        if not matching:
            grid = self.study.sweeps[sweep].grid
            raise InvalidField("where", f"must be values of the grid {grid}, got {dict(where)}")
        return matching


def runs_of(study: Study, folder: Path, beside: Path) -> Plan:
    """Return the runs of a study; see `plan`.

    Raises `ValueError`, which names the field, for specs that are wrong.
    """
    # First: to list all combinations of many values takes hours.
    wanted = sum(map(_count, study.sweeps.values()))
    if wanted > MAX_RUNS:
        raise ValueError(f"a study needs at most {MAX_RUNS:,} runs in all, got {wanted:,}")
    bases: dict[str, Spec] = {}
    runs: list[PlannedRun] = []
    for name, sweep in study.sweeps.items():
        field = f"sweeps.{name}"
        document = _base(sweep, field, beside)
        seeds = sweep.seeds
        if isinstance(seeds, int):
            seeds = list(range(document["seed"], document["seed"] + seeds))
        bases[name] = _parsed({**document, "seed": seeds[0]}, f"{field}.set")
        for seed in seeds:
            runs += _cases(name, sweep, {**document, "seed": seed}, folder)
    return Plan(study, folder, bases, tuple(runs))


def _count(sweep: Sweep) -> int:
    """Return the number of runs of a sweep: cases times seeds."""
    seeds = sweep.seeds if isinstance(sweep.seeds, int) else len(sweep.seeds)
    return prod(map(len, sweep.grid.values())) * seeds


def _cases(name: str, sweep: Sweep, document: dict[str, Any], folder: Path) -> list[PlannedRun]:
    """Return the runs of a seed. Raises `ValueError` where two cases are one run."""
    field, found = f"sweeps.{name}", dict[str, PlannedRun]()
    for given in paths.combinations(sweep.grid):
        spec = _case(document, given, field)
        path = folder / "runs" / f"{identity(spec)[:SHORT]}.h5"
        run = PlannedRun(name, _values(spec, given), given, spec, path)
        if (earlier := found.setdefault(run.id, run)) is not run:
            raise ValueError(
                f"{field}.grid: cases must be different runs, got {shown(earlier.given)} and "
                f"{shown(given)}, which are one"
            )
    return list(found.values())


def _values(spec: Spec, given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of a case from its spec; parts, which have defaults, as given."""
    document = spec.model_dump(mode="json")
    values = {path: paths.value(document, path) for path in given}
    return {k: given[k] if isinstance(v, dict | list) else v for k, v in values.items()}


def identity(spec: Spec) -> str:
    """Return the SHA-256 of a spec as canonical JSON (RFC 8785)."""
    # Canonical, so that the order of fields in a file makes no other run.
    return hashlib.sha256(rfc8785.dumps(spec.model_dump(mode="json"))).hexdigest()


def _base(sweep: Sweep, field: str, beside: Path) -> dict[str, Any]:
    """Return the document of a sweep's spec with the fields of `set`."""
    given = sweep.spec
    if isinstance(given, str):
        preset = presets().get(given)
        document = preset.model_dump(mode="json") if preset else _read(given, field, beside)
    else:
        document = given
    spec = _parsed(document, f"{field}.spec")
    document = spec.model_dump(mode="json")
    for path, value in sweep.set.items():
        refuse_path(document, path, f"{field}.set")
        document = paths.replaced(document, path, value)
    for path in sweep.grid:
        if path in ("seed", "experiment"):
            raise ValueError(f"{field}.grid: a grid cannot contain `{path}`; use `seeds`")
        refuse_path(document, path, f"{field}.grid")
        outer = next((x for x in sweep.grid if x != path and paths.inside(path, x)), None)
        if outer is not None:
            raise ValueError(
                f"{field}.grid: `{path}` lies in `{outer}`, which the grid replaces as a whole"
            )
    spec = _parsed(document, f"{field}.set")
    if not isinstance(spec, Evolution):
        raise ValueError(f"{field}.spec: a search is needed, got {spec.experiment}")
    return {**document, "seed": spec.seed}


def _read(name: str, field: str, beside: Path) -> Any:
    path = beside / name
    if not path.is_file():
        known = ", ".join(presets())
        raise ValueError(f"{field}.spec must be a file, or one of {known}; got {name!r}")
    try:
        return read_json(path.read_bytes())
    except ValueError as error:
        raise ValueError(f"{field}.spec: {path} must be JSON: {error}") from error


def refuse_path(document: Mapping[str, Any], path: str, field: str) -> None:
    """Raise `ValueError` where a spec has no field at a path."""
    if not paths.exists(document, path):
        near = paths.nearest(document, path)
        meant = f"; did you mean `{near}`?" if near else ""
        raise ValueError(f"{field}: the spec has no field `{path}`{meant}")


def _case(document: dict[str, Any], values: Mapping[str, Any], field: str) -> Spec:
    for path, value in values.items():
        document = paths.replaced(document, path, value)
    return _parsed(document, f"{field}.grid ({shown(values)})" if values else f"{field}.set")


def shown(values: Mapping[str, Any]) -> str:
    """Return a case as text."""
    return ", ".join(f"{path} {value}" for path, value in values.items())


def _parsed(document: Mapping[str, Any], field: str) -> Spec:
    try:
        return parse(document)
    except ValidationError as error:
        lines = "\n".join(f"{field}: {one}" for one in invalid_fields(error.errors()))
        raise ValueError(lines) from error


@contextmanager
def alone(folder: Path, name: str = "") -> Iterator[None]:
    """Hold the folder of a study. Raises `ValueError` while another process holds it.

    `name` is that of the study's file, where the folder is named by it: its ending tells two
    studies of one folder apart, of which the second is refused.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / ".lock").open("a+", encoding="utf-8", errors="surrogateescape") as file:
        try:
            # The system releases the lock of a process that is killed.
            _lock(file, fcntl.LOCK_NB)
        except BlockingIOError:
            raise ValueError(f"{folder}: another process carries out this study") from None
        file.seek(0)
        if name and name != (earlier := file.read()):
            if earlier:
                raise ValueError(
                    f"{folder}: the folder must be of the study {name}, got that of {earlier}; "
                    "name another folder with --out"
                )
            file.write(name)
            file.flush()  # Before a process that is killed.
        yield


@contextmanager
def of_run(path: Path) -> Iterator[None]:
    """Wait for the file of a run and hold it: a process whose study was killed may still be
    writing its checkpoint."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.with_name(f".{path.stem}.lock").open("w") as file:
        _lock(file)
        yield


def _lock(file: IO[str], how: int = 0) -> None:
    """Lock a file, where the file system has locks."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | how)
    except OSError as error:
        if error.errno not in (ENOLCK, ENOTSUP, ENOSYS):
            raise
