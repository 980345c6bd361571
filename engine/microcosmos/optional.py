"""Import of optional libraries for drawing and encoding."""

from importlib import import_module
from typing import Any


def require(module: str) -> Any:
    """Import a module of an optional library; an error names the command that installs it."""
    try:
        return import_module(module)
    except ImportError as error:
        raise ImportError(
            f'Pictures need {module.partition(".")[0]}: pip install "microcosmos[figures]"'
        ) from error
