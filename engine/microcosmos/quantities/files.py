"""Physical units and numbers without a unit, of creature files and of archive files."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..archive import creature, creature_h5, export, file, measured
from ..archive.export import Source
from ..invalid import InvalidField
from ..spec import Scene, is_unavailable
from . import bodies
from . import scales as scaling
from .bodies import sperm
from .real import Real
from .scales import Physical, columns, own_stroke, scaled_by, scene_of


@dataclass(frozen=True)
class Stroke:
    """The length and the stroke of a creature, and how its body yields."""

    length: float
    """Reach of the body, in cells."""
    period: float
    """Steps of a stroke, as the creature did it if it was measured; see `scales.own_stroke`."""
    sperm: float | None
    """Effective sperm number; None where a joint has no stiffness."""


def physical(source: Mapping[str, Any] | Source, length: str, period: str) -> dict[str, Any]:
    """Return physical units of a creature file, or columns of those of an archive file.

    `length` is the real length of the body, such as `1mm`, `period` that of a stroke, such as
    `0.5s`. Speeds are in m/s and viscosities in m²/s. Raise `ValueError` as `of_creature` and
    `of_archive` do.
    """
    if not isinstance(source, Mapping):
        data = export.source_bytes(source)
        if creature_h5.is_of_run(data):
            return dict(of_archive(data, length, period)[1])
        source = creature_h5.read(data)
    return dict(of_creature(source, length, period)[1])


def of_creature(
    document: Mapping[str, Any], length: str, period: str
) -> tuple[Physical, dict[str, float]]:
    """Return the scales of a creature file, and its numbers: SI units and none.

    The length is that of the body as its genes made it. Raise `ValueError` for a creature
    without a fluid or a stroke, or whose own stroke is unknown.
    """
    # `Real.of` is None only without both texts, which are given here.
    real, parsed = Real.of(length, period), creature.parse(document)
    assert real is not None
    scene, genes = creature.scene_of(parsed), parsed["identity"]["genome"]
    measures = measured.of_creature(parsed["measured"])
    steps = _known_stroke(scene, measures)
    scales = scaled_by(scene, bodies.length_of(scene, genes), real, steps)
    numbers = {name: float(value) for name, value in columns(scales, measures).items()}
    number = sperm(scene, bodies.body_of(scene, genes), steps)
    return scales, numbers | ({} if number is None else {"sperm": number})


def of_archive(
    data: bytes, length: str, period: str
) -> tuple[list[Physical], dict[str, np.ndarray]]:
    """Return the scales of each elite of an archive file, and columns of their numbers.

    Each elite has the given length. Numbers with a time are NaN where its own stroke is
    unknown. `sperm` is NaN there and where a joint has no stiffness, and missing where a
    plug-in that is not loaded builds the body. Raise `ValueError` for a run without an
    archive, a fluid or a stroke.
    """
    real = Real.of(length, period)
    assert real is not None
    scaled, found = scaling.of_archive(data, real)
    tree, attributes = file.load(data)
    scene = scene_of(json.loads(attributes["spec"]))
    if is_unavailable(scene.body):
        return scaled, found
    grown = bodies.elites(scene, tree["archive"]["genomes"])
    numbers = [sperm(scene, body, one.steps) for body, one in zip(grown, scaled, strict=True)]
    return scaled, found | {"sperm": np.array(numbers, float)}


def _known_stroke(scene: Scene, measures: Mapping[str, float]) -> float:
    """Return `own_stroke`; raise `ValueError` where it is unknown or impossible."""
    steps, period = own_stroke(scene, measures), scaling.stroke_of(scene)
    # A clock is only slowed, and two strokes are done within the simulation.
    if not 0.999 * period <= steps <= max(scene.task.steps, period):
        speed, stride = measures["speed"], measures["stride"]
        raise InvalidField(
            "measured.measures.speed",
            f"must be that of strokes of {period:g} to {scene.task.steps:,} steps, which are "
            f"1,000 × stride / speed; got stride {stride:g} and speed {speed:g}, 0 below two "
            "strokes",
        )
    return steps


def stroke(document: Mapping[str, Any]) -> Stroke:
    """Return the length, stroke and sperm number of a parsed creature file.

    Raise `ValueError` for a creature without a stroke, or whose own stroke is unknown.
    """
    scene, genes = creature.scene_of(document), document["identity"]["genome"]
    steps = _known_stroke(scene, measured.of_creature(document["measured"]))
    number = sperm(scene, bodies.body_of(scene, genes), steps)
    return Stroke(bodies.length_of(scene, genes), steps, number)
