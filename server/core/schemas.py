"""Base class of wire types."""

from pydantic import BaseModel, ConfigDict

MAX_INTEGER = (1 << 31) - 1
"""Largest integer of a column; PostgreSQL refuses to compare larger ones."""


class Wire(BaseModel):
    model_config = ConfigDict(extra="forbid", from_attributes=True)
