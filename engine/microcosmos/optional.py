"""Import of optional libraries, which draw and encode."""

from importlib import import_module
from typing import Any


def require(module: str) -> Any:
    """Import a module of an optional library; say what installs it if it is missing."""
    try:
        return import_module(module)
    except ImportError as error:
        raise ImportError(
            f'Pictures need {module.partition(".")[0]}: pip install "microcosmos[figures]"'
        ) from error
