"""Data of each kind of event, and their description in the OpenAPI document."""

from typing import Any
from uuid import UUID

from pydantic import Field
from pydantic.json_schema import models_json_schema

from ..core.schemas import Wire
from ..runs.schemas import RunRead


class Nothing(Wire):
    """No data."""


class RunChange(RunRead):
    """A run has changed, at most once a second while it computes."""

    spec: dict[str, Any] = Field(default={})
    """Left out while the run computes, and if it is long."""


class OfGeneration(Wire):
    run: UUID
    generation: int


class GenerationEvent(OfGeneration):
    """A generation is recorded, with its row of the curves."""

    evaluations: int
    qd_score: float | None
    coverage: float | None
    best: float | None
    mean: float | None
    infeasible: int
    seconds: float
    summary: dict[str, Any] | None


class ElitesEvent(OfGeneration):
    """Elites entered the archive, a column for each of their values, or left it."""

    cell: list[int]
    fitness: list[float]
    descriptors: list[list[float]]
    creature: list[str]
    elite_generation: list[int]
    emptied: list[int]
    """Cells that lost their elite without a new one."""


class ResultsEvent(OfGeneration):
    """Rows of a table are recorded; each names its `creature`, if it has one."""

    summary: dict[str, Any] | None
    rows: list[dict[str, Any]]


class RewindEvent(OfGeneration):
    """An attempt goes on from a checkpoint: drop everything after its generation."""


class PurgeEvent(Wire):
    """A deleted run is gone for good."""

    run: UUID


class SweepEvent(Wire):
    """A sweep has changed."""

    sweep: UUID


EVENTS: dict[str, type[Wire]] = {
    "start": Nothing,
    "reset": Nothing,
    "run": RunChange,
    "generation": GenerationEvent,
    "elites": ElitesEvent,
    "results": ResultsEvent,
    "rewind": RewindEvent,
    "purge": PurgeEvent,
    "sweep": SweepEvent,
}
"""The data of each event by its kind. A stream begins with `start`; at `reset` a client reads
everything again."""


def describe(document: dict[str, Any]) -> None:
    """Have an OpenAPI document state the kinds of events, and the data of each."""
    names, found = models_json_schema(
        [(model, "serialization") for model in set(EVENTS.values())],
        ref_template="#/components/schemas/{model}",
    )
    known = document["components"]["schemas"]
    known |= {name: schema for name, schema in found["$defs"].items() if name not in known}
    content = document["paths"]["/api/v1/events"]["get"]["responses"]["200"]["content"]
    content["text/event-stream"]["itemSchema"] = {
        "oneOf": [_item(kind, names[model, "serialization"]) for kind, model in EVENTS.items()]
    }


def _item(kind: str, schema: dict[str, Any]) -> dict[str, Any]:
    data = {"type": "string", "contentMediaType": "application/json", "contentSchema": schema}
    properties = {"id": {"type": "string"}, "event": {"const": kind}, "data": data}
    return {"type": "object", "properties": properties, "required": list(properties)}
