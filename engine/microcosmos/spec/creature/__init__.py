"""The creature file: identity, genome, measured numbers and provenance."""

from .file import CreatureError, CreatureFile, check, fitness_of, room, scene_of
from .identity import Identity
from .plan import PlanDrawing, plan_drawing
