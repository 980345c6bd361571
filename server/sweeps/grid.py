"""The cases of a grid, and the errors of their specs by the responsible value."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from pydantic import ValidationError

from microcosmos.spec import Spec, paths

from ..core.errors import FieldError, field_errors, invalid_fields
from ..runs.schemas import NAME_LENGTH
from ..specs.parsing import Parse

MAX_ERRORS = 20


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
    named = "" if f"`{error.field}`" in error.message else f"{error.field}: "
    return relocated(error, field, f"with {combination(values)}: {named}")


def related_paths(field: str, values: Mapping[str, Any]) -> list[str]:
    """Return the paths that lead to a field, into it, or to a part that contains it."""
    return [path for path in values if paths.inside(field, path) or paths.inside(path, field)]


def _refuse_alike(cases: Sequence[Case]) -> None:
    seen: dict[str, Case] = {}
    for case in cases:
        document = json.dumps(case.spec.model_dump(mode="json"), sort_keys=True)
        earlier = seen.setdefault(document, case)
        if earlier is not case:
            path = next(p for p in case.places if case.places[p] != earlier.places[p])
            message = f"gives the same run as {earlier.field(path)}: {combination(case.values)}"
            raise invalid_fields(FieldError(field=case.field(path), message=message))


def relocated(error: FieldError, field: str, before: str = "") -> FieldError:
    message = before + error.message
    return error.model_copy(update={"field": field, "message": message})


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
