"""Diagnosis: checks of the requirements of Microcosmos, with advice."""

from .examination import examine
from .machine import Finding
