"""Bodies that grow from genes: plans, their growth, and the kinematics of what has grown."""

from .body import Grown, State
from .columns import plan_of
from .form import form
from .graph import grown_body, grown_length
from .plan import LEAST_LIMB, LEAST_RING, LEAST_ROOT, Capacity, Plan
from .random import (
    FIRST_LIMBS,
    PLAN_DRAWS,
    SEGMENT_DRAWS,
    TYPES,
    Segments,
    random_plan,
    random_segment,
)
from .skeleton import Skeleton, skeleton
from .sprouting import grow, sprout
