"""Import of optional libraries."""

from importlib import import_module
from typing import Any


def require(module: str, package: str = "microcosmos[figures]") -> Any:
    """Import a module of an optional library; say what installs it if it is missing."""
    try:
        return import_module(module)
    except ImportError as error:
        name = module.partition(".")[0]
        raise ImportError(f'{name} is needed: pip install "{package}"') from error
