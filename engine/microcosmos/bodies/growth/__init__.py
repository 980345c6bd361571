"""Bodies that grow from genes: plans, their growth, and the kinematics of grown bodies."""

from .form import form
from .plan import (
    FIRST_LIMBS,
    LEAST_LIMB,
    LEAST_RING,
    LEAST_ROOT,
    PLAN_DRAWS,
    SEGMENT_DRAWS,
    TYPES,
    Capacity,
    Grown,
    Plan,
    Segments,
    State,
    plan_of,
    random_plan,
    random_segment,
)
from .skeleton import Skeleton, grown_body, grown_length, skeleton
from .sprouting import grow, sprout
