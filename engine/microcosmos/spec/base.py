"""The base class of all parts of a spec, and the declaration of their fields."""

from collections.abc import Sequence
from typing import Any

from pydantic import BaseModel, ConfigDict, Field
from pydantic.config import JsonDict


class Part(BaseModel):
    """A frozen part of a spec; unknown fields, NaN and infinities are refused."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        allow_inf_nan=False,
        use_attribute_docstrings=True,
        validate_default=True,
    )


def unit(name: str) -> JsonDict:
    """Return the unit of a field, for forms and the reference."""
    return {"unit": name}


def field(default: Any, *, unit: str = "", source: str = "", **limits: Any) -> Any:
    """Declare a field: its default, unit, the source of its method, and pydantic's limits."""
    given = {"unit": unit, "source": source}
    extra: JsonDict = {name: text for name, text in given.items() if text}
    return Field(default=default, json_schema_extra=extra or None, **limits)


SELDOM = ConfigDict(json_schema_extra={"seldom": True})
"""Marks a part that people seldom change: a form shows it closed."""

ENCODINGS = ("cppn", "direct", "weights", "cppn-body", "gait", "fold", "plugin")
BUILDERS = ("chain", "ring", "arc", "walk", "star", "tree", "polyline", "graph")
NETWORK_OPERATORS = ("neat", "population", "lamarckian")
VECTOR_OPERATORS = ("iso+line", "gaussian", "cma-mae", "cma-me", "cma-mega")
TAGS: dict[str, tuple[str, ...]] = {
    "body": (*BUILDERS, "known", "plugin"),
    "genome": ENCODINGS,
    "control": ENCODINGS,
    "targets": ("digit", "picture"),
    "emitters": ("random", *NETWORK_OPERATORS, *VECTOR_OPERATORS),
}
"""The tags of union fields, which pydantic adds to the paths of errors."""


def field_path(location: Sequence[str | int]) -> str:
    """Return the path of pydantic's error location as people write it, without tags."""
    kept, owner = [], ""
    for part in location:
        if part in TAGS.get(owner, ()):
            continue
        kept.append(str(part))
        owner = part if isinstance(part, str) else owner
    return ".".join(kept)
