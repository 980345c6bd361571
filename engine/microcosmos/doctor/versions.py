"""Check Python and the installed packages."""

import operator
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
COMPARISONS = {
    ">=": operator.ge,
    "<=": operator.le,
    "==": operator.eq,
    "!=": operator.ne,
    ">": operator.gt,
    "<": operator.lt,
}


def python() -> Iterator[Finding]:
    found = f"{platform.python_version()} on {platform.machine()} {platform.system()}"
    low, high = PYTHONS
    if low <= sys.version_info[:2] < high:
        yield ok("Python", found)
    else:
        yield problem("Python", found, "install Python 3.11 or 3.12: make PYTHON=python3.12")


def packages() -> Iterator[Finding]:
    """Compare the installed packages with the requirements of this version."""
    yield ok("Microcosmos", VERSION)
    try:
        needed = requires("microcosmos") or []
    except PackageNotFoundError:
        advice = "pip install . in its folder"
        yield warning("packages", "microcosmos itself is not installed", advice)
        return
    faults = list(filter(None, map(_fault, needed)))
    for fault in faults:
        yield problem("packages", fault, "make install, or pip install --upgrade")
    if not faults:
        names = ("jax", "jaxlib", "equinox", "h5py")
        yield ok("packages", ", ".join(f"{name} {version(name)}" for name in names))


def _fault(line: str) -> str | None:
    """Say what violates a requirement; a package of an extra may be absent, but not old."""
    match = REQUIREMENT.match(line)
    if not match:
        return None
    name, needed, marker = match[1], match[2].strip(), match[3]
    try:
        found = version(name)
    except PackageNotFoundError:
        return None if marker else f"{name}{needed} is needed and not installed"
    return (
        None if satisfied(found, needed) else f"{name}{needed} is needed; {found} is installed"
    )


def satisfied(found: str, needed: str) -> bool:
    """Compare a version with simple bounds; others are left to pip."""
    here = _numbers(found)
    return all(COMPARISONS[how](here, _numbers(bound)) for how, bound in CLAUSE.findall(needed))


def _numbers(text: str) -> tuple[int, ...]:
    """Return the release, padded so that 1.2 and 1.2.0 are the same."""
    leading = re.match(r"\d+(?:\.\d+)*", text)
    numbers = [int(part) for part in leading[0].split(".")] if leading else []
    return tuple(numbers + [0] * (6 - len(numbers)))
