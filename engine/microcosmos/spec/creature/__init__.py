"""The creature file: identity, genome, measured numbers and provenance."""

from .file import (
    CreatureError,
    CreatureFile,
    Identity,
    alone,
    check,
    fitness_of,
    room,
    scene_of,
)
from .plan import PlanDrawing, plan_drawing
