"""What people look at: replays, and the check that they are what was recorded."""

from .check import Check, check
from .replay import record

__all__ = ["Check", "check", "record"]
