"""The body plan of a creature, for the page."""

import json

from microcosmos.spec.creature import PlanDrawing, plan_drawing

from ..core.errors import ProblemError


def drawing(identity: bytes) -> PlanDrawing:
    """Grow the body of a creature; raise `ProblemError` where its genes are no plan."""
    creature = json.loads(identity)
    try:
        return plan_drawing(creature)
    except ValueError as error:
        raise ProblemError(
            404, "No plan", f"The creature has no body plan: {error}."
        ) from error
