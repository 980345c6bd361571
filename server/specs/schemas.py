"""Kinds of run with their schemas and presets."""

from typing import Any

from pydantic import ConfigDict

from ..core.schemas import Wire


class PresetRead(Wire):
    name: str
    title: str
    spec: dict[str, Any]


class ExperimentRead(Wire):
    experiment: str
    title: str
    schema_: dict[str, Any]
    presets: list[PresetRead]

    model_config = ConfigDict(
        extra="forbid",
        populate_by_name=True,
        serialize_by_alias=True,
        alias_generator=lambda name: name.rstrip("_"),
    )
