"""The runs of a study: each has an identity, by which finished ones are recognised."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import rfc8785
from pydantic import ValidationError

from ..archive.file import load
from ..spec import Evolution, Spec, parse, paths
from ..spec.base import field_path
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
        """The first characters of the SHA-256 of the spec as canonical JSON."""
        return self.path.stem

    def done(self) -> tuple[int, bool]:
        """Return the last generation in its file, 0 without one, and whether it is finished."""
        if not self.path.exists():
            return 0, False
        tree, attributes = load(self.path.read_bytes(), only=("curves",))
        return len(tree["curves"]["evaluations"]), json.loads(attributes["ended"]) is not None


@dataclass(frozen=True, eq=False)
class Plan:
    study: Study
    folder: Path
    """Where runs, figures, exports and the report go."""
    bases: dict[str, Spec]
    """The spec of each sweep before the grid, with the first seed."""
    runs: tuple[PlannedRun, ...]

    def unique(self) -> list[PlannedRun]:
        """Return the runs without those that another sweep has too."""
        return list({run.id: run for run in reversed(self.runs)}.values())[::-1]

    def of(self, sweep: str, where: Mapping[str, Any]) -> list[PlannedRun]:
        """Return the runs of a sweep whose cases have some values. Raises `ValueError` where
        the grid has no such values."""
        found = [
            run
            for run in self.runs
            if run.sweep == sweep
            and all(
                k in run.given and v in (run.values[k], run.given[k]) for k, v in where.items()
            )
        ]
        if not found:
            grid = self.study.sweeps[sweep].grid
            raise ValueError(f"`where` must be values of the grid {grid}, got {dict(where)}")
        return found


def plan(study: Study, folder: Path, beside: Path) -> Plan:
    """Return the runs of a study; `beside` is the folder of files with specs.

    Raises `ValueError`, which names the field, for specs that are wrong.
    """
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
    if len(runs) > MAX_RUNS:
        raise ValueError(f"a study needs at most {MAX_RUNS:,} runs in all, got {len(runs):,}")
    return Plan(study, folder, bases, tuple(runs))


def _cases(name: str, sweep: Sweep, document: dict[str, Any], folder: Path) -> list[PlannedRun]:
    """Return the runs of a seed. Raises `ValueError` where two cases are one run."""
    field, found = f"sweeps.{name}", dict[str, PlannedRun]()
    for given in paths.combinations(sweep.grid):
        spec = _case(document, given, field)
        path = folder / "runs" / f"{identity(spec)[:SHORT]}.h5"
        run = PlannedRun(name, _values(spec, given), given, spec, path)
        if (earlier := found.setdefault(run.id, run)) is not run:
            raise ValueError(
                f"{field}.grid: cases must be different runs, got {_shown(earlier.given)} and "
                f"{_shown(given)}, which are one"
            )
    return list(found.values())


def _values(spec: Spec, given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of a case from its spec; parts, which have defaults, as given."""
    document = spec.model_dump(mode="json")
    found = {path: paths.value(document, path) for path in given}
    return {k: given[k] if isinstance(v, dict | list) else v for k, v in found.items()}


def identity(spec: Spec) -> str:
    """Return the SHA-256 of a spec as canonical JSON (RFC 8785)."""
    return hashlib.sha256(rfc8785.dumps(spec.model_dump(mode="json"))).hexdigest()


def _base(sweep: Sweep, field: str, beside: Path) -> dict[str, Any]:
    """Return the document of a sweep's spec with the fields of `set`."""
    given = sweep.spec
    if isinstance(given, str):
        found = presets().get(given)
        document = found.model_dump(mode="json") if found else _read(given, field, beside)
    else:
        document = given
    spec = _parsed(document, f"{field}.spec")
    document = spec.model_dump(mode="json")
    for path, value in sweep.set.items():
        _refuse_path(document, path, f"{field}.set")
        document = paths.replaced(document, path, value)
    for path in sweep.grid:
        if path in ("seed", "experiment"):
            raise ValueError(f"{field}.grid: a grid cannot contain `{path}`; use `seeds`")
        _refuse_path(document, path, f"{field}.grid")
    if not isinstance(spec, Evolution):
        raise ValueError(f"{field}.spec: a search is needed, got {spec.experiment}")
    return document


def _read(name: str, field: str, beside: Path) -> Any:
    path = beside / name
    if not path.is_file():
        known = ", ".join(presets())
        raise ValueError(f"{field}.spec must be a file, or one of {known}; got {name!r}")
    try:
        return json.loads(path.read_bytes())
    except ValueError as error:
        raise ValueError(f"{field}.spec: {path} must be JSON: {error}") from error


def _refuse_path(document: dict[str, Any], path: str, field: str) -> None:
    if not paths.exists(document, path):
        near = paths.nearest(document, path)
        meant = f"; did you mean `{near}`?" if near else ""
        raise ValueError(f"{field}: the spec has no field `{path}`{meant}")


def _case(document: dict[str, Any], values: Mapping[str, Any], field: str) -> Spec:
    for path, value in values.items():
        document = paths.replaced(document, path, value)
    return _parsed(document, f"{field}.grid ({_shown(values)})" if values else f"{field}.set")


def _shown(values: Mapping[str, Any]) -> str:
    return ", ".join(f"{path} {value}" for path, value in values.items())


def _parsed(document: Mapping[str, Any], field: str) -> Spec:
    try:
        return parse(document)
    except ValidationError as error:
        found = "\n".join(
            f"{field}: {field_path(e['loc'])}: {e['msg']}" for e in error.errors()
        )
        raise ValueError(found.replace("Value error, ", "")) from error
