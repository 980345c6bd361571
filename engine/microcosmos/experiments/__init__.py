"""The kinds of run, one file each."""

from collections.abc import Callable
from typing import Any, Protocol

from ..archive.report import Report
from ..search import Stopped
from .resume_check import OtherDevice, OtherSpec


class Experiment(Protocol):
    """A run as pure functions of a state, which holds all that the next generation needs.

    `generation` of a state is the number of completed generations.
    """

    def init(self) -> Any:
        """Return the state before the first generation."""
        ...

    @property
    def device(self) -> str:
        """The kind of device on which the bits of its results depend."""
        ...

    def done(self, state: Any) -> bool:
        """Return whether all generations are completed."""
        ...

    def advance(self, state: Any, stop: Callable[[], bool] = ...) -> tuple[Any, Report]:
        """Compute one generation.

        Raise `Stopped` if `stop()` is true between blocks; `state` stays valid then. Otherwise
        it must not be used again, since a large archive is overwritten.
        """
        ...

    def save(self, state: Any) -> bytes:
        """Return the file from which the run can be resumed."""
        ...

    def restore(self, data: bytes, *, other_device: bool = False) -> Any:
        """Return the state in a file of the same spec.

        Raises `ValueError` for another format, and its subclasses `OtherSpec` for another spec,
        and `OtherDevice` for another kind of device unless `other_device` allows it: from there
        on bits may differ, and the file says so.
        """
        ...

    def best(self, state: Any) -> dict[str, Any] | None:
        """Return the creature file of the best creature, if the experiment has one."""
        ...
