"""The kinds of run, one file each."""

from ..search import Stopped
from .report import Elite, Report

__all__ = ["Elite", "Report", "Stopped"]
