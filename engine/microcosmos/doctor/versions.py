"""Check Python and the installed packages."""

import platform
import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, requires, version

from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.version import Version

from ..version import VERSION
from .finding import Finding, ok, problem, warning


def python() -> Iterator[Finding]:
    found = f"{platform.python_version()} on {platform.machine()} {platform.system()}"
    if (3, 11) <= sys.version_info[:2] < (3, 13):
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
    faults = list(filter(None, map(_fault, map(Requirement, needed))))
    for fault in faults:
        yield problem("packages", fault, "make install, or pip install --upgrade")
    if not faults:
        names = ("jax", "jaxlib", "equinox", "h5py")
        yield ok("packages", ", ".join(f"{name} {version(name)}" for name in names))


def _fault(needed: Requirement) -> str | None:
    """Name a violated requirement; a package of an extra may be absent, but not old."""
    text = f"{needed.name}{needed.specifier} is needed"
    try:
        found = version(needed.name)
    except PackageNotFoundError:
        return None if needed.marker else f"{text} and not installed"
    return None if satisfied(found, needed.specifier) else f"{text}; {found} is installed"


def satisfied(found: str, needed: SpecifierSet) -> bool:
    """Return whether a version is within bounds; a pre-release counts as its release."""
    return Version(found).base_version in needed
