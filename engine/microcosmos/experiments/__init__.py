"""The kinds of run, one file each."""

from ..search import Stopped
from .archive_file import OtherDevice
from .report import Elite, Report

__all__ = ["Elite", "OtherDevice", "Report", "Stopped"]
