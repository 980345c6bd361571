"""Descent from creatures that people choose while a run goes on."""

from collections.abc import Mapping
from typing import Any

from .base import Part, field, sourced
from .emitters import STATELESS, VARYING
from .sources import BREEDING


class Breeding(Part):
    """Descent from creatures that people choose while the run goes on.

    From the next generation on a part of each batch descends from the chosen by the run's own
    variation; the rest is as without a choice.
    """

    model_config = sourced(BREEDING, seldom=True)

    share: float = field(0.5, gt=0.0, le=1.0)
    """Share of the first generation's offspring that descend from the chosen."""
    half_life: float = field(10.0, gt=0.0, le=1e6, unit="generations")
    """Generations in which this share halves; older choices also count less beside newer ones
    in this proportion."""


def breeding_refusal(spec: Mapping[str, Any]) -> str | None:
    """Return why runs of a spec, a document, cannot descend from chosen creatures; None if they
    can."""
    if spec["experiment"] != "quality-diversity":
        return (
            "`experiment` must be 'quality-diversity' to descend from chosen creatures: others "
            f"draw no parents from an archive, got {spec['experiment']!r}"
        )
    operators = [emitter["operator"] for emitter in spec["search"]["emitters"]]
    if learners := [operator for operator in operators if operator not in STATELESS]:
        return (
            f"`search.emitters` must be among {', '.join(STATELESS)} to descend from chosen "
            f"creatures, got {learners[0]!r}, which learns from all of its offspring"
        )
    if not set(operators) & set(VARYING):
        return (
            f"`search.emitters` must contain one of {', '.join(VARYING)} to descend from "
            "chosen creatures, got only 'random', whose offspring have no parents"
        )
    return None
