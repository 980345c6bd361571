"""Diagnosis: check what Microcosmos needs, and say what to do."""

from .examination import examine
from .finding import Finding
