"""What makes the numbers of a creature: its length, its stroke, and how its body yields."""

import json

from pydantic import TypeAdapter

from microcosmos.viz.physical import Stroke, stroke

from ..core.errors import ProblemError

FORM = "stroke"
ANSWER = TypeAdapter(Stroke)


def write(identity: bytes) -> bytes:
    """Return them as JSON; raise `ProblemError` for a creature without a stroke.

    Call it only in the sandbox: it grows the body, and seeks the modes of its joints.
    """
    try:
        found = stroke({"identity": json.loads(identity), "measured": None})
    except ValueError as error:
        detail = f"The creature has no sperm number: {error}."
        raise ProblemError(404, "No stroke", detail) from error
    return ANSWER.dump_json(found)
