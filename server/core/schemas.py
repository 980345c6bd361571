"""Base class of wire types, and the wire type of errors."""

from typing import Any

from pydantic import BaseModel, ConfigDict

MAX_INTEGER = (1 << 31) - 1
"""Largest integer of a column; PostgreSQL refuses to compare larger ones."""


class Wire(BaseModel):
    model_config = ConfigDict(extra="forbid", from_attributes=True)


class FieldError(Wire):
    field: str
    message: str
    needed: str | None = None
    got: Any = None


class Problem(BaseModel):
    """RFC 9457."""

    type: str = "about:blank"
    title: str
    status: int
    detail: str
    errors: list[FieldError] | None = None
