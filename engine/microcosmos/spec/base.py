"""What every part of a spec shares: nothing unknown is accepted and nothing changes."""

from collections.abc import Sequence

from pydantic import BaseModel, ConfigDict
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


TAGS: dict[str, tuple[str, ...]] = {
    "body": (
        "chain",
        "ring",
        "arc",
        "walk",
        "star",
        "tree",
        "polyline",
        "graph",
        "known",
        "plugin",
    ),
    "genome": ("cppn", "direct", "weights", "cppn-body", "gait", "fold", "plugin"),
    "control": ("cppn", "direct", "weights", "cppn-body", "gait", "fold", "plugin"),
    "targets": ("digit", "picture"),
    "emitters": (
        "random",
        "neat",
        "population",
        "iso+line",
        "gaussian",
        "cma-mae",
        "cma-me",
        "lamarckian",
        "cma-mega",
    ),
}
"""Fields that are one of several parts, and what pydantic puts behind them in errors."""


def field_path(location: Sequence[str | int]) -> str:
    """Where pydantic found an error, as people write it: without tags of unions."""
    kept, owner = [], ""
    for part in location:
        if part in TAGS.get(owner, ()):
            continue
        kept.append(str(part))
        owner = part if isinstance(part, str) else owner
    return ".".join(kept)


def unit(name: str) -> JsonDict:
    """The unit of a field, for the forms that people fill in."""
    return {"unit": name}


SELDOM = ConfigDict(json_schema_extra={"seldom": True})
"""Marks a part that people seldom change: a form shows it closed."""
