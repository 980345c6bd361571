"""From a request for a sweep to the specs of its runs, all of them proved before any is."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import prod
from typing import Any

import rfc8785
from pydantic import ValidationError

from microcosmos.spec import Spec

from . import grid
from .own_specs import Parse
from .problems import Refused, brief, field_errors, invalid_input
from .schemas import MOST, NAME, FieldError, SweepSent
from .submission import TOO_LARGE, too_large

TOLD = 20
"""Errors that one answer lists at most."""
FIXED = {
    "seed": "`seed` is not for a grid: `seeds` says which there are",
    "experiment": "all runs of a sweep are of one experiment",
}


@dataclass(frozen=True)
class Case:
    """One combination of the grid's values."""

    values: dict[str, Any]
    places: dict[str, int]
    """Where in the lists of the grid these values are."""
    spec: Spec

    def field(self, path: str) -> str:
        return f"grid.{path}[{self.places[path]}]"


@dataclass(frozen=True)
class Plan:
    """All runs of a sweep."""

    name: str | None
    spec: Spec
    seeds: list[int]
    grid: dict[str, list[Any]]
    cases: list[Case]

    @property
    def total(self) -> int:
        return len(self.cases) * max(1, len(self.seeds))

    def runs(self) -> Iterator[tuple[str | None, dict[str, Any]]]:
        """Their names and specs: every case with the first seed, then with the next."""
        documents = [case.spec.model_dump(mode="json") for case in self.cases]
        for seed in self.seeds or [None]:
            for case, document in zip(self.cases, documents, strict=True):
                seeded = document if seed is None else {**document, "seed": seed}
                yield run_name(self.name, case.values, seed), seeded


def plan(sent: SweepSent, parse: Parse) -> Plan:
    """The runs that are asked for; `Refused` where any of them could not be."""
    base = _base(sent.spec, parse)
    document = base.model_dump(mode="json")
    _refuse_paths(document, sent.grid)
    seeds = _seeds(sent, document, parse)
    _refuse_many(sent, max(1, len(seeds)))
    if seeds:
        document = {**document, "seed": seeds[0]}
    cases = _cases(document, sent.grid, parse)
    return Plan(sent.name or None, base, seeds, dict(sent.grid), cases)


def _base(document: Mapping[str, Any], parse: Parse) -> Spec:
    try:
        return parse(document)
    except ValidationError as error:
        raise _refused([_moved(e, f"spec.{e.field}") for e in field_errors(error)]) from None


def _refuse_paths(document: dict[str, Any], asked: Mapping[str, Sequence[Any]]) -> None:
    """Fields that are none, or that a grid cannot run over."""
    errors = [error for path in asked if (error := _wrong_path(document, path, asked))]
    if errors:
        raise _refused(errors)


def _wrong_path(
    document: dict[str, Any], path: str, asked: Mapping[str, Any]
) -> FieldError | None:
    if path in FIXED:
        return FieldError(field=f"grid.{path}", message=FIXED[path])
    if not grid.exists(document, path):
        near = grid.nearest(document, path)
        meant = f"; did you mean `{near}`?" if near else ""
        message = f"the spec has no field `{path}`{meant}"
        return FieldError(field=f"grid.{path}", message=message, needed=near, got=path)
    outer = next((one for one in asked if one != path and grid.inside(path, one)), None)
    if outer is not None:
        message = f"`{path}` lies in `{outer}`, which the grid replaces as a whole"
        return FieldError(field=f"grid.{path}", message=message)
    return None


def _seeds(sent: SweepSent, document: dict[str, Any], parse: Parse) -> list[int]:
    """Those asked for; none where the experiment leaves nothing to chance."""
    if "seed" not in document:
        if sent.seeds == 1:
            return []
        message = (
            f"a run of `{document['experiment']}` has no seed, so that all would be the same; "
            "leave `seeds` out"
        )
        raise _refused([FieldError(field="seeds", message=message, got=brief(sent.seeds))])
    if isinstance(sent.seeds, list):
        return sent.seeds
    first, last = document["seed"], document["seed"] + sent.seeds - 1
    try:
        parse({**document, "seed": last})
    except ValidationError as error:
        (found,) = field_errors(error)
        message = f"from the spec's own, {first}, {sent.seeds} seeds end at {last}: "
        raise _refused([_moved(found, "seeds", message)]) from None
    return list(range(first, last + 1))


def _refuse_many(sent: SweepSent, seeds: int) -> None:
    lengths = [len(values) for values in sent.grid.values()]
    total = prod(lengths) * seeds
    if total <= MOST:
        return
    factors = " x ".join(f"{count}" for count in (*lengths, seeds))
    message = f"needs at most {MOST:,} runs in all; got {factors} = {total:,}"
    field = "grid" if sent.grid else "seeds"
    raise _refused([FieldError(field=field, message=message, needed=f"{MOST}", got=total)])


def _cases(
    document: dict[str, Any], asked: Mapping[str, Sequence[Any]], parse: Parse
) -> list[Case]:
    """Every combination, the last field fastest; `Refused` with all that is wrong with any."""
    cases: list[Case] = []
    errors: dict[str, FieldError] = {}
    for places in product(*(range(len(values)) for values in asked.values())):
        at = dict(zip(asked, places, strict=True))
        values = {path: asked[path][place] for path, place in at.items()}
        try:
            cases.append(Case(values, at, parse(_replaced(document, values))))
        except ValidationError as error:
            for found in field_errors(error):
                blamed = _blamed(found, values, at)
                errors.setdefault(blamed.field, blamed)
    if errors:
        raise _refused(list(errors.values())[:TOLD])
    _refuse_alike(cases)
    return cases


def _replaced(document: dict[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    for path, value in values.items():
        document = grid.replaced(document, path, value)
    return document


def _blamed(error: FieldError, values: dict[str, Any], places: dict[str, int]) -> FieldError:
    """An error of a combination, at the value that is to blame where that can be told."""
    own = _concerned(error.field, values)
    to_blame = own or (list(values) if len(values) == 1 else [])
    field = f"grid.{to_blame[0]}[{places[to_blame[0]]}]" if to_blame else "grid"
    by_itself = error.field in own and error.needed is not None
    if by_itself or not values:
        return _moved(error, field)
    named = "" if f"`{error.field}`" in error.message else f"{error.field}: "
    return _moved(error, field, f"with {combination(values)}: {named}")


def _concerned(field: str, values: Mapping[str, Any]) -> list[str]:
    """The paths that lead to a field, to a part of it, or to what it is part of."""
    return [path for path in values if grid.inside(field, path) or grid.inside(path, field)]


def _refuse_alike(cases: Sequence[Case]) -> None:
    """Two combinations that are one and the same run."""
    seen: dict[bytes, Case] = {}
    for case in cases:
        earlier = seen.setdefault(rfc8785.dumps(case.spec.model_dump(mode="json")), case)
        if earlier is not case:
            path = next(p for p in case.places if case.places[p] != earlier.places[p])
            message = f"gives the same run as {earlier.field(path)}: {combination(case.values)}"
            raise _refused([FieldError(field=case.field(path), message=message)])


def refuse_too_large(plan: Plan, limit: int) -> None:
    """Raise `Refused` where no worker has the memory for one of the runs."""
    errors: dict[str, FieldError] = {}
    for case in plan.cases:
        if found := too_large(case.spec, limit):
            own = _concerned(found.field, case.values)
            field = case.field(own[0]) if own else f"spec.{found.field}"
            told = f"with {combination(case.values)}: " if case.values else ""
            errors.setdefault(field, _moved(found, field, told))
    if errors:
        told = list(errors.values())[:TOLD]
        raise Refused(422, TOO_LARGE, "; ".join(error.message for error in told), told)


def _moved(error: FieldError, field: str, before: str = "") -> FieldError:
    message = before + error.message
    return error.model_copy(update={"field": field, "message": message})


def _refused(errors: list[FieldError]) -> Refused:
    problem = invalid_input(errors)
    return Refused(problem.status, problem.title, problem.detail, problem.errors)


def run_name(name: str | None, values: Mapping[str, Any], seed: int | None) -> str | None:
    """What a run of a sweep is called; its seed stays where all of it would be too long."""
    case = " · ".join(filter(None, [name, combination(values, " · ")]))
    seeded = "" if seed is None else f"seed {seed}"
    room = NAME - len(seeded) - len(" · ")
    if len(case) > room:
        case = f"{case[: room - 1]}…"
    return " · ".join(filter(None, [case, seeded])) or None


def combination(values: Mapping[str, Any], between: str = ", ") -> str:
    """The values of a case, each with its field."""
    return between.join(f"{path}={_short(value)}" for path, value in values.items())


def _short(value: Any) -> str:
    text = value if isinstance(value, str) else rfc8785.dumps(value).decode()
    return text if len(text) <= 60 else f"{text[:59]}…"
