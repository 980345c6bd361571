"""What is known of something of one's own wherever it is talked about: words, no code."""

import re
from typing import Annotated, Any, Final, Literal, Self, get_args

from pydantic import BaseModel, ConfigDict, Field, model_validator

Kind = Literal["fitness", "descriptor", "body", "gait", "encoding"]
KINDS: Final = get_args(Kind)

NAME = r"[a-z][a-z0-9_]{0,62}"
"""Of a module, and of what is in it."""
FULL_NAME = re.compile(rf"{NAME}\.{NAME}")

Size = Annotated[int, Field(ge=0, le=65_536)]


def is_plugin(name: object) -> bool:
    """Whether a name is of something of one's own: nothing built in has a dot in its name."""
    return isinstance(name, str) and FULL_NAME.fullmatch(name) is not None


class Axis(BaseModel):
    """Where an archive's axis begins and ends, unless its spec says otherwise."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    low: float
    high: float
    scale: Literal["linear", "log10"] = "linear"

    @model_validator(mode="after")
    def refuse_empty(self) -> Self:
        if self.high <= self.low:
            raise ValueError(f"`high` must be above `low` ({self.low:g}), got {self.high:g}")
        if self.scale == "log10" and self.low <= 0:
            raise ValueError(f"`low` must be above 0 where `scale` is log10, got {self.low:g}")
        return self


class Declaration(BaseModel):
    """A name, what it stands for, and which version of its module says so."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    kind: Kind
    name: Annotated[str, Field(pattern=rf"^{FULL_NAME.pattern}$")]
    """That of its module, a dot, and its own."""
    source: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    """SHA-256 of the module's source."""
    title: Annotated[str, Field(min_length=1, max_length=100)]
    unit: Annotated[str, Field(max_length=40)] = ""
    about: Annotated[str, Field(max_length=1000)] = ""
    """A sentence for people."""
    axis: Axis | None = None
    """Of a descriptor."""
    sizes: dict[str, Size] = {}
    """`nodes` that a body has at most; `genes`, `per_joint` and `per_edge` of an encoding."""
    settings: dict[str, Any] | None = None
    """JSON schema of its settings, if it has any."""
    defaults: dict[str, Any] = {}
    """The settings where nobody says otherwise."""
