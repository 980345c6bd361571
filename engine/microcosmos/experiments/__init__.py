"""The kinds of run, one file each."""

from collections.abc import Callable
from typing import Any, Protocol

from ..archive.report import Elite, Report, Row
from ..search import Stopped
from .resume_check import OtherDevice

__all__ = ["Elite", "Experiment", "OtherDevice", "Report", "Row", "Stopped"]


class Experiment(Protocol):
    """A run, driven by whoever holds it; its state is all that the next generation needs."""

    def init(self) -> Any:
        """Before the first generation."""
        ...

    def done(self, state: Any) -> bool:
        """Whether all generations are completed."""
        ...

    def generation(self, state: Any) -> int:
        """Generations completed."""
        ...

    def advance(self, state: Any, stop: Callable[[], bool] = ...) -> tuple[Any, Report]:
        """One generation; raises `Stopped` where `stop()` says so, `state` stays as it was."""
        ...

    def save(self, state: Any) -> bytes:
        """The file from which the run can be taken up again."""
        ...

    def restore(self, data: bytes, *, other_device: bool = False) -> Any:
        """The state in a file of the same spec; raises `ValueError` or `OtherDevice`."""
        ...

    def best(self, state: Any) -> dict[str, Any] | None:
        """The creature file of the best creature, where there is such a thing."""
        ...
