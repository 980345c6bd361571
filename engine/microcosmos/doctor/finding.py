"""What was looked at, what was found, and what to do about it."""

from dataclasses import asdict, dataclass
from typing import Any, Literal

Level = Literal["ok", "warning", "problem"]
GIB = 1 << 30


@dataclass(frozen=True)
class Finding:
    """`advice` says what to do; it is there unless all is well."""

    subject: str
    level: Level
    found: str
    advice: str | None = None

    def __post_init__(self) -> None:
        assert (self.advice is None) == (self.level == "ok")

    def document(self) -> dict[str, Any]:
        return asdict(self)


def ok(subject: str, found: str) -> Finding:
    return Finding(subject, "ok", found)


def warning(subject: str, found: str, advice: str) -> Finding:
    return Finding(subject, "warning", found, advice)


def problem(subject: str, found: str, advice: str) -> Finding:
    return Finding(subject, "problem", found, advice)


def gib(count: float) -> str:
    """Bytes, as people speak of memory and disks."""
    return f"{count / GIB:.1f} GiB" if count >= GIB else f"{count / (1 << 20):.0f} MiB"
