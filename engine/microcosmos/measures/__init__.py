"""Measures of creatures: one table, free of JAX and of pydantic."""

from .declaration import Group, Measure, Scale, descriptor, refuse_empty_axis
from .table import (
    FORMS,
    GROUPS,
    MEASURES,
    NAMED,
    RECORDED,
    SUMMARISED,
    WITHOUT_GRADIENT,
    MeasureName,
)
