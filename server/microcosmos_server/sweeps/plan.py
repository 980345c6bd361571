"""Plan a sweep: the cases of its grid, whose specs are checked before any run is created."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from itertools import product
from math import prod
from typing import Any

from pydantic import ValidationError
from sqlalchemy.orm import Session

from microcosmos.sizes import size
from microcosmos.spec import Spec, paths
from microcosmos.spec.creature import CreatureError

from ..core.errors import (
    FieldError,
    Invalid,
    field_errors,
    invalid_fields,
    problem_of,
    shortened,
)
from ..creatures import initial
from ..runs.schemas import NAME_LENGTH
from ..runs.submission import TOO_LARGE, too_large
from ..specs.parsing import Parse
from .schemas import MAX_RUNS, SweepCreate

MAX_ERRORS = 20
# Each run of a sweep has its own copy. A usual spec has 5 kB.
MAX_SPEC_BYTES = 50_000_000
"""Limit on the specs of all runs of a sweep, as JSON."""
# One transaction inserts a row for each: 200,000 rows took 2.9 s on SQLite and 740,000 took
# 13 s, in which no worker can write. Writers give up after 15 s.
MAX_INITIAL = 200_000
"""Limit on the initial creatures of all runs of a sweep."""


@dataclass(frozen=True)
class Case:
    """One combination of the grid's values."""

    values: dict[str, Any]
    places: dict[str, int]
    """Indices of the values in the lists of the grid."""
    spec: Spec

    def field(self, path: str) -> str:
        return f"grid.{path}[{self.places[path]}]"


def cases_of(
    document: dict[str, Any], asked: Mapping[str, Sequence[Any]], parse: Parse
) -> list[Case]:
    """Return every combination, the last field fastest; raise all errors as one."""
    cases: list[Case] = []
    errors: dict[str, FieldError] = {}
    for places in product(*(range(len(values)) for values in asked.values())):
        at = dict(zip(asked, places, strict=True))
        values = {path: asked[path][place] for path, place in at.items()}
        changed = document
        for path, value in values.items():
            changed = paths.replaced(changed, path, value)
        try:
            cases.append(Case(values, at, parse(changed)))
        except ValidationError as error:
            for found in field_errors(error):
                error_of_value = _at_value(found, values, at)
                errors.setdefault(error_of_value.field, error_of_value)
    if errors:
        raise invalid_fields(*list(errors.values())[:MAX_ERRORS])
    _refuse_alike(cases)
    return cases


def _at_value(error: FieldError, values: dict[str, Any], places: dict[str, int]) -> FieldError:
    """Relocate an error of a case to the responsible value, if one can be identified."""
    related = related_paths(error.field, values)
    responsible = related or (list(values) if len(values) == 1 else [])
    field = f"grid.{responsible[0]}[{places[responsible[0]]}]" if responsible else "grid"
    by_itself = error.field in related and error.needed is not None
    if by_itself or not values:
        return relocated(error, field)
    named = f"`{error.field}` " if error.field else ""
    return relocated(error, field, f"with {combination(values)}: {named}")


def related_paths(field: str, values: Mapping[str, Any]) -> list[str]:
    """Return the paths that lead to a field, into it, or to a part that contains it."""
    return [path for path in values if paths.inside(field, path) or paths.inside(path, field)]


def _refuse_alike(cases: Sequence[Case]) -> None:
    seen: dict[bytes, Case] = {}
    for case in cases:
        earlier = seen.setdefault(_digest(case.spec), case)
        if earlier is not case:
            path = next(p for p in case.places if case.places[p] != earlier.places[p])
            reason = f"gives the same run as {earlier.field(path)}: {combination(case.values)}"
            raise invalid_fields(FieldError(field=case.field(path), reason=reason))


def _digest(spec: Spec, include: Any = None) -> bytes:
    """Return the hash of a spec, or of some of its fields: a thousand specs may be long."""
    document = spec.model_dump(mode="json", include=include)
    # Sorted, since the order of a plug-in's settings makes no other run.
    return sha256(json.dumps(document, sort_keys=True).encode()).digest()


def relocated(error: FieldError, field: str, before: str = "") -> FieldError:
    return error.model_copy(update={"field": field, "reason": before + error.reason})


def run_name(name: str | None, values: Mapping[str, Any], seed: int | None) -> str | None:
    """Return the name of a run; if it is too long, the seed stays."""
    case = " · ".join(filter(None, [name, combination(values, " · ")]))
    seeded = "" if seed is None else f"seed {seed}"
    room = NAME_LENGTH - len(seeded) - len(" · ")
    if len(case) > room:
        case = f"{case[: room - 1]}…"
    return " · ".join(filter(None, [case, seeded])) or None


def combination(values: Mapping[str, Any], between: str = ", ") -> str:
    return between.join(f"{path}={_short(value)}" for path, value in values.items())


def _short(value: Any) -> str:
    text = value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:59]}…"


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
    """Return the plan of a request; raise `DomainError` if any of its runs is invalid."""
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
    _refuse_many(sent, max(1, len(seeds)), document)
    if seeds:
        document = {**document, "seed": seeds[0]}
    cases = cases_of(document, sent.grid, parse)
    _refuse_many_initial(sent, max(1, len(seeds)), cases)
    return Plan(sent.name or None, base, seeds, dict(sent.grid), cases)


def _wrong_path(
    document: dict[str, Any], path: str, asked: Mapping[str, Any]
) -> FieldError | None:
    if path in FIXED:
        return FieldError(field=f"grid.{path}", reason=FIXED[path])
    if not paths.exists(document, path):
        near = paths.nearest(document, path)
        meant = f"; did you mean `{near}`?" if near else ""
        reason = f"the spec has no field `{path}`{meant}"
        return FieldError(field=f"grid.{path}", reason=reason, needed=near, got=path)
    outer = next((one for one in asked if one != path and paths.inside(path, one)), None)
    if outer is not None:
        reason = f"`{path}` lies in `{outer}`, which the grid replaces as a whole"
        return FieldError(field=f"grid.{path}", reason=reason)
    return None


def _seeds(sent: SweepCreate, document: dict[str, Any], parse: Parse) -> list[int]:
    """Return the seeds; none if the experiment has no seed."""
    if "seed" not in document:
        if sent.seeds == 1:
            return []
        reason = (
            f"a run of `{document['experiment']}` has no seed, so all runs would be the same; "
            "omit `seeds`"
        )
        raise invalid_fields(
            FieldError(field="seeds", reason=reason, got=shortened(sent.seeds))
        )
    if isinstance(sent.seeds, list):
        return sent.seeds
    first, last = document["seed"], document["seed"] + sent.seeds - 1
    try:
        parse({**document, "seed": last})
    except ValidationError as error:
        (found,) = field_errors(error)
        reason = f"from the spec's own, {first}, {sent.seeds} seeds end at {last}: "
        raise invalid_fields(relocated(found, "seeds", reason)) from None
    return list(range(first, last + 1))


def _refuse_many(sent: SweepCreate, seeds: int, document: dict[str, Any]) -> None:
    lengths = [len(values) for values in sent.grid.values()]
    total = prod(lengths) * seeds
    factors = " x ".join(f"{count}" for count in (*lengths, seeds))
    length = len(json.dumps(document))
    length += sum(len(json.dumps(values)) // len(values) for values in sent.grid.values())
    if total > MAX_RUNS:
        needed, got = f"at most {MAX_RUNS:,} runs in all", f"{factors} = {total:,}"
    elif total * length > MAX_SPEC_BYTES:
        needed = f"specs of at most {size(MAX_SPEC_BYTES)} in all"
        got = f"{total:,} of some {size(length)}"
    else:
        return
    raise _too_many(sent, needed, got)


def _refuse_many_initial(sent: SweepCreate, seeds: int, cases: Sequence[Case]) -> None:
    total = seeds * sum(len(initial.initial_of(case.spec)) for case in cases)
    if total > MAX_INITIAL:
        runs = seeds * len(cases)
        needed = f"at most {MAX_INITIAL:,} initial creatures in all runs"
        raise _too_many(sent, needed, f"{total:,} in {runs:,} runs")


def _too_many(sent: SweepCreate, needed: str, got: str) -> Invalid:
    field = "grid" if sent.grid else "seeds"
    reason = f"needs {needed}; got {got}"
    return invalid_fields(FieldError(field=field, reason=reason, needed=needed, got=got))


def refuse_too_large(plan: Plan, limit: int) -> None:
    """Raise `DomainError` if no worker has the memory for one of the runs."""
    errors: dict[str, FieldError] = {}
    for case in plan.cases:
        if found := too_large(case.spec, limit):
            placed = _at_field(found, case)
            errors.setdefault(placed.field, placed)
    if errors:
        some = list(errors.values())[:MAX_ERRORS]
        raise Invalid("; ".join(error.reason for error in some), some, title=TOO_LARGE)


def refuse_initial(session: Session, plan: Plan) -> None:
    """Raise `DomainError` if one of the runs cannot start from its initial creatures."""
    include = initial.COMPATIBILITY_FIELDS
    cases = {_digest(case.spec, include): case for case in plan.cases}
    for case in cases.values():
        try:
            initial.check(session, case.spec)
        except CreatureError as error:
            found = problem_of(error).errors or []
            raise invalid_fields(*(_at_field(one, case) for one in found)) from error


def _at_field(found: FieldError, case: Case) -> FieldError:
    """Relocate an error of a case's spec to the field of the request."""
    related = related_paths(found.field, case.values)
    field = case.field(related[0]) if related else f"spec.{found.field}"
    return relocated(
        found,
        field,
        f"with {combination(case.values)}: `{found.field}` " if case.values else "",
    )
