"""Declarations of plug-ins: names, versions and settings, without code."""

import re
from typing import Annotated, Any, Final, Literal, Self, get_args

from pydantic import BaseModel, ConfigDict, Field, model_validator

Kind = Literal["fitness", "descriptor", "body", "gait", "encoding"]
KINDS: Final = get_args(Kind)

NAME = r"[a-z][a-z0-9_]{0,62}"
"""Pattern of a module's name, and of a plug-in's name in it."""
FULL_NAME = re.compile(rf"{NAME}\.{NAME}")

Size = Annotated[int, Field(ge=0, le=65_536)]


def is_plugin(name: object) -> bool:
    """Return whether a name is that of a plug-in: it contains a dot, built-in names do not."""
    return isinstance(name, str) and FULL_NAME.fullmatch(name) is not None


class Axis(BaseModel):
    """Default ends and scale of an archive's axis."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    low: float
    high: float
    scale: Literal["linear", "log10"] = "linear"

    @model_validator(mode="after")
    def refuse_empty(self) -> Self:
        refuse_empty_axis(self.low, self.high, self.scale)
        return self


def refuse_empty_axis(low: float, high: float, scale: str = "linear") -> None:
    """Raise `ValueError` where an axis has no length, or no logarithm."""
    if high <= low:
        raise ValueError(f"`high` must be above `low` ({low:g}), got {high:g}")
    if scale == "log10" and low <= 0:
        raise ValueError(f"`low` must be above 0 where `scale` is log10, got {low:g}")


class Declaration(BaseModel):
    """The name, kind and version of a plug-in."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    kind: Kind
    name: Annotated[str, Field(pattern=rf"^{FULL_NAME.pattern}$")]
    """Name of the module, a dot, and the plug-in's name."""
    source: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    """SHA-256 of the module's source."""
    title: Annotated[str, Field(min_length=1, max_length=100)]
    unit: Annotated[str, Field(max_length=40)] = ""
    about: Annotated[str, Field(max_length=1000)] = ""
    """Description in one sentence."""
    axis: Axis | None = None
    """Axis of a descriptor."""
    sizes: dict[str, Size] = {}
    """Most `nodes` of a body; `genes`, `per_joint` and `per_edge` of an encoding."""
    settings: dict[str, Any] | None = None
    """JSON schema of the settings, if there are any."""
    defaults: dict[str, Any] = {}
    """Default settings."""
