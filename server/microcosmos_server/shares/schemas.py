"""Wire types of shares."""

from datetime import datetime
from typing import Annotated, Literal, Self
from uuid import UUID

from pydantic import BeforeValidator, Field, StringConstraints, model_validator

from microcosmos.invalid import InvalidField
from microcosmos.spec.base import Digest

from ..core.schemas import Moment, Wire

ShareState = Literal["live", "expired", "revoked"]
Line = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=200)]
Licence = Annotated[
    str, StringConstraints(strip_whitespace=True, min_length=1, max_length=10_000)
]


Credit = Annotated[
    list[Line],
    Field(max_length=20),
    BeforeValidator(lambda sent: [sent] if isinstance(sent, str) else sent),
]


class Terms(Wire):
    """Fields that a publisher sets and everybody reads; each is a column of shares."""

    expires_at: Moment | None = None
    listed: bool = False
    """List the share in the commons too."""


class ShareCreate(Terms):
    """A request for a share; the creature's file supplies the defaults."""

    creature: Digest | None = None
    run: UUID | None = None
    generation: int | None = Field(default=None, ge=1)
    """The last generation of the run that the share shows; by default that of its last file."""
    title: Line | None = None
    credit: Credit = Field(default=[])
    """People to name, beside those whom the creature's file names already."""
    licence: Licence | None = None
    """An SPDX name or a text."""

    @model_validator(mode="after")
    def check_subject(self) -> Self:
        if (self.creature is None) == (self.run is None):
            got = "none" if self.run is None else "both"
            raise InvalidField("creature", f"must be set, or `run`, but only one; got {got}")
        if self.creature and self.generation is not None:
            raise InvalidField(
                "generation", f"needs a `run`; got {self.generation} with a creature"
            )
        return self


class ShareRead(Terms):
    """A share of a `creature`, or of the archive of a `run` up to a `generation`."""

    slug: str
    url: str
    """The address of its page."""
    creature: str | None
    run: UUID | None
    generation: int | None
    cover: str
    trusted: bool | None
    """The verdict of the creature's audit; null for an archive, or without an audit."""
    title: str
    credit: list[str]
    licence: str
    created_at: datetime
    revoked_at: datetime | None
    state: ShareState


class SharedCreatures(Wire):
    """Names of creatures, the best first."""

    creatures: list[Digest]


class SharePage(Wire):
    items: list[ShareRead]
    next: str | None
