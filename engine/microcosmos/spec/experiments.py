"""The kinds of experiments, and the parsing of a JSON document into a spec."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, cast

from pydantic import TypeAdapter, ValidationError
from pydantic_core import InitErrorDetails, PydanticCustomError

from ..plugins import Catalogue
from . import folding, gaits, neuroevolution, quality_diversity, refinement, scaling
from .base import Part
from .folding import Folding
from .gaits import Gaits
from .neuroevolution import Neuroevolution
from .plugins import CONTEXT
from .quality_diversity import QualityDiversity
from .refinement import Refinement
from .scaling import Scaling

Spec = QualityDiversity | Neuroevolution | Folding | Refinement | Gaits | Scaling
"""Any experiment's spec."""


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
    about: str
    """Half a sentence, which may follow the title."""
    spec: type[Part]
    presets: tuple[Preset, ...]


def _experiment(about: str, module: Any, spec: type[Part]) -> Experiment:
    presets = tuple(Preset(name, *rest) for name, rest in module.PRESETS.items())
    name = spec.model_fields["experiment"].default
    return Experiment(name, name.capitalize(), about, spec, presets)


_ALL = (
    ("the fittest swimmer in every cell", quality_diversity, QualityDiversity),
    ("NEAT, one swimmer", neuroevolution, Neuroevolution),
    ("filaments that fold into pictures", folding, Folding),
    ("one creature made fitter by gradients", refinement, Refinement),
    ("five swimmers at every viscosity", gaits, Gaits),
    ("wall time against the number of nodes", scaling, Scaling),
)
EXPERIMENTS = {one.name: one for one in (_experiment(*parts) for parts in _ALL)}


def presets() -> dict[str, Spec]:
    """Return presets by experiment and name, those of quality-diversity also by name alone."""
    named = {f"{e.name}/{p.name}": p.spec for e in EXPERIMENTS.values() for p in e.presets}
    return {p.name: p.spec for p in EXPERIMENTS["quality-diversity"].presets} | named


def parse(document: Mapping[str, Any], known: Catalogue | None = None) -> Spec:
    """Return the spec in a document that names its `experiment`.

    `known` lists the available plug-ins; by default, those loaded in this process. Raises
    `pydantic.ValidationError`, whose errors name each field, what was needed and what came.
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
    return TypeAdapter(cast(type[Spec], experiment.spec)).validate_python(
        document, context={CONTEXT: known} if known else None
    )
