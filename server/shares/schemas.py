"""What people publish, and what is told of it to whoever has the address."""

from datetime import datetime
from typing import Annotated, Any, Literal, Self
from uuid import UUID

from pydantic import AwareDatetime, BeforeValidator, Field, StringConstraints, model_validator

from ..core.schemas import Wire

ShareState = Literal["live", "expired", "revoked"]
Digest = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
Line = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=200)]
Licence = Annotated[
    str, StringConstraints(strip_whitespace=True, min_length=1, max_length=10_000)
]


def listed(credit: Any) -> Any:
    """One name may stand by itself."""
    return [credit] if isinstance(credit, str) else credit


Credit = Annotated[list[Line], Field(max_length=20), BeforeValidator(listed)]


class ShareAsked(Wire):
    """What is to be published; what is left out is taken from the creature's file."""

    creature: Digest | None = None
    run: UUID | None = None
    generation: int | None = Field(default=None, ge=1)
    """The last one of the run that is seen; the one of its last file where none is named."""
    title: Line | None = None
    credit: Credit = Field(default=[])
    """People to be named, beside those whom the creature's file names already."""
    licence: Licence | None = None
    """An SPDX name or a text."""
    expires_at: AwareDatetime | None = None
    listed: bool = False
    """Whether it stands in the commons too."""

    @model_validator(mode="after")
    def check_subject(self) -> Self:
        if (self.creature is None) == (self.run is None):
            came = "none" if self.run is None else "both"
            raise ValueError(
                f"`creature` needs to be named, or `run`, but one only; got {came}"
            )
        if self.creature and self.generation is not None:
            raise ValueError(
                f"`generation` needs a `run`; got {self.generation} with a creature"
            )
        return self


class ShareRead(Wire):
    """Either `creature` or `run` is what was shared, an archive up to `generation`."""

    slug: str
    url: str
    """Where people look at it."""
    creature: str | None
    run: UUID | None
    generation: int | None
    cover: str
    """The creature whose picture stands for it."""
    title: str
    credit: list[str]
    licence: str
    listed: bool
    created_at: datetime
    expires_at: datetime | None
    revoked_at: datetime | None
    state: ShareState


class SharePage(Wire):
    items: list[ShareRead]
    next: str | None
