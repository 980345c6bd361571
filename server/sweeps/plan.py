"""Plan a sweep: check the specs of all its runs before any run is created."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import prod
from typing import Any

from pydantic import ValidationError
from sqlalchemy.orm import Session

from microcosmos.spec import Spec, paths
from microcosmos.spec.creature import CreatureError

from ..core.errors import (
    FieldError,
    ProblemError,
    field_errors,
    invalid_fields,
    problem_of,
    shortened,
)
from ..creatures import initial
from ..runs.submission import TOO_LARGE, too_large
from ..specs.parsing import Parse
from .grid import MAX_ERRORS, Case, cases_of, combination, related_paths, relocated, run_name
from .schemas import MAX_RUNS, SweepCreate

FIXED = {
    "seed": "a grid cannot contain `seed`; use `seeds`",
    "experiment": "a grid cannot contain `experiment`: all runs of a sweep share one",
}


@dataclass(frozen=True)
class Plan:
    name: str | None
    spec: Spec
    seeds: list[int]
    grid: dict[str, list[Any]]
    cases: list[Case]

    @property
    def total(self) -> int:
        return len(self.cases) * max(1, len(self.seeds))

    def runs(self) -> Iterator[tuple[str | None, Spec, dict[str, Any]]]:
        """Yield name, spec and document: all cases with the first seed, then with the next."""
        documents = [case.spec.model_dump(mode="json") for case in self.cases]
        for seed in self.seeds or [None]:
            for case, document in zip(self.cases, documents, strict=True):
                seeded = document if seed is None else {**document, "seed": seed}
                yield run_name(self.name, case.values, seed), case.spec, seeded


def plan(sent: SweepCreate, parse: Parse) -> Plan:
    """Return the plan of a request; raise `ProblemError` if any of its runs is invalid."""
    try:
        base = parse(sent.spec)
    except ValidationError as error:
        errors = [relocated(one, f"spec.{one.field}") for one in field_errors(error)]
        raise invalid_fields(*errors) from None
    document = base.model_dump(mode="json")
    wrong = (_wrong_path(document, path, sent.grid) for path in sent.grid)
    if errors := [error for error in wrong if error]:
        raise invalid_fields(*errors)
    seeds = _seeds(sent, document, parse)
    _refuse_many(sent, max(1, len(seeds)))
    if seeds:
        document = {**document, "seed": seeds[0]}
    cases = cases_of(document, sent.grid, parse)
    return Plan(sent.name or None, base, seeds, dict(sent.grid), cases)


def _wrong_path(
    document: dict[str, Any], path: str, asked: Mapping[str, Any]
) -> FieldError | None:
    if path in FIXED:
        return FieldError(field=f"grid.{path}", message=FIXED[path])
    if not paths.exists(document, path):
        near = paths.nearest(document, path)
        meant = f"; did you mean `{near}`?" if near else ""
        message = f"the spec has no field `{path}`{meant}"
        return FieldError(field=f"grid.{path}", message=message, needed=near, got=path)
    outer = next((one for one in asked if one != path and paths.inside(path, one)), None)
    if outer is not None:
        message = f"`{path}` lies in `{outer}`, which the grid replaces as a whole"
        return FieldError(field=f"grid.{path}", message=message)
    return None


def _seeds(sent: SweepCreate, document: dict[str, Any], parse: Parse) -> list[int]:
    """Return the seeds; none if the experiment has no seed."""
    if "seed" not in document:
        if sent.seeds == 1:
            return []
        message = (
            f"a run of `{document['experiment']}` has no seed, so all runs would be the same; "
            "omit `seeds`"
        )
        raise invalid_fields(
            FieldError(field="seeds", message=message, got=shortened(sent.seeds))
        )
    if isinstance(sent.seeds, list):
        return sent.seeds
    first, last = document["seed"], document["seed"] + sent.seeds - 1
    try:
        parse({**document, "seed": last})
    except ValidationError as error:
        (found,) = field_errors(error)
        message = f"from the spec's own, {first}, {sent.seeds} seeds end at {last}: "
        raise invalid_fields(relocated(found, "seeds", message)) from None
    return list(range(first, last + 1))


def _refuse_many(sent: SweepCreate, seeds: int) -> None:
    lengths = [len(values) for values in sent.grid.values()]
    total = prod(lengths) * seeds
    if total <= MAX_RUNS:
        return
    factors = " x ".join(f"{count}" for count in (*lengths, seeds))
    message = f"needs at most {MAX_RUNS:,} runs in all; got {factors} = {total:,}"
    field = "grid" if sent.grid else "seeds"
    error = FieldError(field=field, message=message, needed=f"{MAX_RUNS}", got=total)
    raise invalid_fields(error)


def refuse_too_large(plan: Plan, limit: int) -> None:
    """Raise `ProblemError` if no worker has the memory for one of the runs."""
    errors: dict[str, FieldError] = {}
    for case in plan.cases:
        if found := too_large(case.spec, limit):
            placed = _at_field(found, case)
            errors.setdefault(placed.field, placed)
    if errors:
        some = list(errors.values())[:MAX_ERRORS]
        raise ProblemError(422, TOO_LARGE, "; ".join(error.message for error in some), some)


def refuse_initial(session: Session, plan: Plan) -> None:
    """Raise `ProblemError` if one of the runs cannot start from its initial creatures."""
    include = initial.COMPATIBILITY_FIELDS
    alike = {case.spec.model_dump_json(include=include): case for case in plan.cases}
    for case in alike.values():
        try:
            initial.check(session, case.spec)
        except CreatureError as error:
            found = problem_of(error).errors or []
            raise invalid_fields(*(_at_field(one, case) for one in found)) from error


def _at_field(found: FieldError, case: Case) -> FieldError:
    """Relocate an error of a case's spec to the field of the request."""
    related = related_paths(found.field, case.values)
    field = case.field(related[0]) if related else f"spec.{found.field}"
    return relocated(found, field, f"with {combination(case.values)}: " if case.values else "")
