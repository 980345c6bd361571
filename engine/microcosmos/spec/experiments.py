"""The experiments there are, and the way from a JSON document to a spec."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import TypeAdapter, ValidationError
from pydantic_core import InitErrorDetails, PydanticCustomError

from . import quality_diversity
from .quality_diversity import QualityDiversity

Spec = QualityDiversity
"""Any experiment's spec; a union once there are several."""


@dataclass(frozen=True)
class Preset:
    name: str
    title: str
    spec: Spec


@dataclass(frozen=True)
class Experiment:
    """A kind of run that people can choose."""

    name: str
    title: str
    spec: type[Spec]
    presets: tuple[Preset, ...]


EXPERIMENTS = {
    "quality-diversity": Experiment(
        "quality-diversity",
        "Quality-diversity: the best swimmer of every kind",
        QualityDiversity,
        tuple(Preset(n, t, s) for n, (t, s) in quality_diversity.PRESETS.items()),
    ),
}


def parse(document: Mapping[str, Any]) -> Spec:
    """The spec in a document, its `experiment` named.

    Raises `pydantic.ValidationError`, whose errors name each field, what was needed and
    what came.
    """
    name = document.get("experiment") if isinstance(document, Mapping) else document
    experiment = EXPERIMENTS.get(name) if isinstance(name, str) else None
    if experiment is None:
        needed = ", ".join(repr(name) for name in EXPERIMENTS)
        error = PydanticCustomError(
            "unknown_experiment", "Input should be one of {needed}", {"needed": needed}
        )
        details = InitErrorDetails(type=error, loc=("experiment",), input=name)
        raise ValidationError.from_exception_data("Spec", [details])
    return TypeAdapter(experiment.spec).validate_python(document)
