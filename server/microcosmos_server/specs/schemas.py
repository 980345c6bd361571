"""Wire types of experiments with schemas and presets, and of the drawing of a spec."""

from collections.abc import Iterable
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, ConfigDict, WithJsonSchema

from microcosmos.spec import EXPERIMENTS, solid_runs, targets

from ..core.schemas import Wire

SPEC_SCHEMA = {
    "type": "object",
    "required": ["experiment"],
    "properties": {"experiment": {"enum": sorted(EXPERIMENTS)}},
    "description": "A spec; `GET /experiments` has the schema of each experiment.",
}
SpecDocument = Annotated[dict[str, Any], WithJsonSchema(SPEC_SCHEMA)]
"""A spec as it is sent: `microcosmos.spec` checks it and names fields as people write them."""


class PresetRead(Wire):
    name: str
    title: str
    spec: dict[str, Any]


class ExperimentRead(Wire):
    experiment: str
    title: str
    about: str
    schema_: dict[str, Any]
    presets: list[PresetRead]

    model_config = ConfigDict(
        extra="forbid",
        populate_by_name=True,
        serialize_by_alias=True,
        alias_generator=lambda name: name.rstrip("_"),
    )


class BodyRead(Wire):
    """A body at rest in its world; a large one is drawn with a part of its nodes."""

    name: str
    nodes: int
    """Number of all nodes."""
    positions: Annotated[list[list[float]], BeforeValidator(lambda at: at.round(3).tolist())]
    """[x, y] in cells."""
    edges: Annotated[list[list[int]], BeforeValidator(lambda edges: edges.tolist())]
    whole: bool
    """Every filament is drawn."""


class PictureRead(Wire):
    name: str
    width: int
    height: int
    pixels: str
    """Base64 of one byte a pixel, row by row from the top; 255 is ink."""


def pictures(drawn: Iterable[tuple[str, Any]]) -> list[PictureRead]:
    """Convert pictures, given by name and ink (row, column)."""
    return [
        PictureRead(
            name=name, width=ink.shape[1], height=ink.shape[0], pixels=targets.encoded(ink)
        )
        for name, ink in drawn
    ]


def runs_of(solid: np.ndarray | None) -> list[int]:
    """Return the runs of a mask, none where nothing is solid."""
    return [] if solid is None else solid_runs(solid)


class DrawingRead(Wire):
    """Bodies, each in a world of its own, obstacles, and the pictures that they fold into."""

    width: int
    height: int
    bodies: list[BodyRead]
    pictures: Annotated[list[PictureRead], BeforeValidator(pictures)]
    picture_size: int
    """The longer side of a picture, in cells."""
    solid: Annotated[list[int], BeforeValidator(runs_of)]
    """Lengths of runs of cells (x, y) that are fluid, solid, fluid and so on; empty: none."""
