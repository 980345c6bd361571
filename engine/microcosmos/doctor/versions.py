"""Python and the packages that the library asks for."""

import platform
import re
import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, requires, version

from ..version import VERSION
from .finding import Finding, ok, problem, warning

PYTHONS = ((3, 11), (3, 13))
"""From the first, up to but without the second."""
REQUIREMENT = re.compile(r"([\w.-]+)(?:\[[^]]*\])?\s*\(?([^;)]*)\)?\s*(?:;(.*))?")
CLAUSE = re.compile(r"(>=|<=|==|!=|>|<)\s*([\d.]+)")
INSTALL = "make install, or pip install --upgrade"


def python() -> Iterator[Finding]:
    """The interpreter."""
    here = sys.version_info[:2]
    found = f"{platform.python_version()} on {platform.machine()} {platform.system()}"
    low, high = PYTHONS
    if low <= here < high:
        yield ok("Python", found)
    else:
        yield problem("Python", found, "install Python 3.11 or 3.12: make PYTHON=python3.12")


def packages() -> Iterator[Finding]:
    """What is installed, against what this version asks for."""
    yield ok("Microcosmos", VERSION)
    try:
        asked = requires("microcosmos") or []
    except PackageNotFoundError:
        yield warning(
            "packages", "microcosmos itself is not installed", "pip install . in its folder"
        )
        return
    wrong = [fault for line in asked if (fault := _fault(line))]
    for fault in wrong:
        yield problem("packages", fault, INSTALL)
    if not wrong:
        told = (f"{name} {version(name)}" for name in ("jax", "jaxlib", "equinox", "h5py"))
        yield ok("packages", ", ".join(told))


def _fault(line: str) -> str | None:
    """What is wrong with a requirement, if anything; extras may be absent, but not old."""
    match = REQUIREMENT.match(line)
    if not match:
        return None
    name, needed, marker = match[1], match[2].strip(), match[3] or ""
    try:
        found = version(name)
    except PackageNotFoundError:
        return None if marker else f"{name}{needed} is needed and not installed"
    if satisfied(found, needed):
        return None
    return f"{name}{needed} is needed; {found} is installed"


def satisfied(found: str, needed: str) -> bool:
    """Whether a version is within simple bounds; others are left to pip."""
    tests = {
        ">=": lambda a, b: a >= b,
        "<=": lambda a, b: a <= b,
        "==": lambda a, b: a == b,
        "!=": lambda a, b: a != b,
        ">": lambda a, b: a > b,
        "<": lambda a, b: a < b,
    }
    here = _numbers(found)
    return all(tests[how](here, _numbers(bound)) for how, bound in CLAUSE.findall(needed))


def _numbers(text: str) -> tuple[int, ...]:
    """The release, padded so that 1.2 and 1.2.0 are the same."""
    leading = re.match(r"\d+(?:\.\d+)*", text)
    numbers = [int(part) for part in leading[0].split(".")] if leading else []
    return tuple(numbers + [0] * (6 - len(numbers)))
