"""Libraries that draw and encode, which not everybody installs."""

from importlib import import_module
from typing import Any


def require(module: str) -> Any:
    """A module of an optional library."""
    try:
        return import_module(module)
    except ImportError as error:
        raise ImportError(
            f'Pictures need {module.partition(".")[0]}: pip install "microcosmos[figures]"'
        ) from error
