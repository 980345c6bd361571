"""The combinations of a grid's values, and which value is to blame where one is refused."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from pydantic import ValidationError

from microcosmos.spec import Spec

from ..core.errors import ProblemError, field_errors, invalid_input
from ..core.schemas import FieldError
from ..runs.schemas import NAME
from ..specs.parsing import Parse
from . import fields

TOLD = 20
"""Errors that one answer lists at most."""


@dataclass(frozen=True)
class Case:
    """One combination of the grid's values."""

    values: dict[str, Any]
    places: dict[str, int]
    """Where in the lists of the grid these values are."""
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
        try:
            cases.append(Case(values, at, parse(_replaced(document, values))))
        except ValidationError as error:
            for found in field_errors(error):
                blamed = _blamed(found, values, at)
                errors.setdefault(blamed.field, blamed)
    if errors:
        raise refused(list(errors.values())[:TOLD])
    _refuse_alike(cases)
    return cases


def _replaced(document: dict[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    for path, value in values.items():
        document = fields.replaced(document, path, value)
    return document


def _blamed(error: FieldError, values: dict[str, Any], places: dict[str, int]) -> FieldError:
    """An error of a combination, at the value that is to blame where that can be told."""
    own = concerned(error.field, values)
    to_blame = own or (list(values) if len(values) == 1 else [])
    field = f"grid.{to_blame[0]}[{places[to_blame[0]]}]" if to_blame else "grid"
    by_itself = error.field in own and error.needed is not None
    if by_itself or not values:
        return moved(error, field)
    named = "" if f"`{error.field}`" in error.message else f"{error.field}: "
    return moved(error, field, f"with {combination(values)}: {named}")


def concerned(field: str, values: Mapping[str, Any]) -> list[str]:
    """The paths that lead to a field, to a part of it, or to what it is part of."""
    return [path for path in values if fields.inside(field, path) or fields.inside(path, field)]


def _refuse_alike(cases: Sequence[Case]) -> None:
    """Two combinations that are one and the same run."""
    seen: dict[str, Case] = {}
    for case in cases:
        document = json.dumps(case.spec.model_dump(mode="json"), sort_keys=True)
        earlier = seen.setdefault(document, case)
        if earlier is not case:
            path = next(p for p in case.places if case.places[p] != earlier.places[p])
            message = f"gives the same run as {earlier.field(path)}: {combination(case.values)}"
            raise refused([FieldError(field=case.field(path), message=message)])


def moved(error: FieldError, field: str, before: str = "") -> FieldError:
    message = before + error.message
    return error.model_copy(update={"field": field, "message": message})


def refused(errors: list[FieldError]) -> ProblemError:
    problem = invalid_input(errors)
    return ProblemError(problem.status, problem.title, problem.detail, problem.errors)


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
    text = value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:59]}…"
