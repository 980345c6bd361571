"""The environment of an export: Python, machine, and versions of packages."""

import platform
from importlib.metadata import PackageNotFoundError, requires, version
from typing import Any

from packaging.requirements import Requirement

ROOTS = ("microcosmos", "microcosmos-kernels")


def packages() -> dict[str, str]:
    """Return the versions of this library and of all packages that it needs, as installed."""
    found: dict[str, str] = {}
    waiting: list[str] = list(ROOTS)
    while waiting:
        name = waiting.pop()
        if name in found:
            continue
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
        for text in requires(name) or ():
            one = Requirement(text)
            if one.marker is None or one.marker.evaluate({"extra": ""}):
                waiting.append(one.name.lower().replace("_", "-"))
    return dict(sorted(found.items()))


def environment() -> dict[str, Any]:
    """Return Python, system, machine and packages of this process."""
    return {
        "python": platform.python_version(),
        "system": platform.system(),
        "machine": platform.machine(),
        "packages": packages(),
    }


def requirements(found: dict[str, Any]) -> str:
    """Return the packages as pip reads them."""
    return "".join(f"{name}=={number}\n" for name, number in found["packages"].items())
