"""All checks, in order."""

import os
from collections.abc import Callable, Iterator
from pathlib import Path

from .machine import Finding, devices, memory, packages, problem, python
from .server import server


def examine(url: str | None, token: str | None, cache: Path) -> Iterator[Finding]:
    """Check the library, then ask the server; `cache` is the default compile cache."""
    compiled = Path(os.environ.get("JAX_COMPILATION_CACHE_DIR") or cache)
    checks: dict[str, Callable[[], Iterator[Finding]]] = {
        "Python": python,
        "packages": packages,
        "devices": lambda: devices(compiled),
        "memory": memory,
        "server": lambda: server(url, token),
    }
    for subject, check in checks.items():
        try:
            yield from check()
        except Exception as error:  # A check that fails must not prevent the others.
            failure = f"the check failed: {type(error).__name__}: {error}"
            yield problem(subject, failure, "resolve this, or report it as a bug of doctor")
