"""The result of a check, and what to do about it."""

from dataclasses import dataclass
from typing import Literal

Level = Literal["ok", "warning", "problem"]


@dataclass(frozen=True)
class Finding:
    """`advice` says what to do; only an `ok` has none."""

    subject: str
    level: Level
    found: str
    advice: str | None = None

    def __post_init__(self) -> None:
        assert (self.advice is None) == (self.level == "ok")


def ok(subject: str, found: str) -> Finding:
    return Finding(subject, "ok", found)


def warning(subject: str, found: str, advice: str) -> Finding:
    return Finding(subject, "warning", found, advice)


def problem(subject: str, found: str, advice: str) -> Finding:
    return Finding(subject, "problem", found, advice)
