"""Choices of people, as the worker of an attempt reads them."""

from collections.abc import Sequence
from typing import Any

from ..choices import choosing
from ..core.database import retried
from ..creatures import initial
from .attempt import Attempt


@retried
def begin(attempt: Attempt, generation: int) -> list[dict[str, Any]]:
    """Return the files of creatures that count from a generation on, before it is computed.

    What people choose later counts from another one, also if this one is repeated.
    """
    with attempt.current() as (session, run):
        return initial.files(session, choosing.begin(session, run, generation))


@retried
def forget(attempt: Attempt, generation: int, creatures: Sequence[str]) -> None:
    """Delete choices of creatures that the run no longer has."""
    with attempt.current() as (session, run):
        choosing.forget(session, run, generation, creatures)
