"""Import of optional libraries."""

from importlib import import_module
from typing import Any


def require(module: str, package: str = "microcosmos[figures]") -> Any:
    """Import a module of an optional library; an error names the command that installs it."""
    try:
        return import_module(module)
    except ImportError as error:
        name = module.partition(".")[0]
        raise ImportError(f'{name} is needed: pip install "{package}"') from error
