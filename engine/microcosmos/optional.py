<<<<<<< HEAD
"""Import of optional libraries."""
=======
"""Import of optional libraries for drawing and encoding."""
>>>>>>> main

from importlib import import_module
from typing import Any


<<<<<<< HEAD
def require(module: str, package: str = "microcosmos[figures]") -> Any:
    """Import a module of an optional library; say what installs it if it is missing."""
=======
def require(module: str) -> Any:
    """Import a module of an optional library; an error names the command that installs it."""
>>>>>>> main
    try:
        return import_module(module)
    except ImportError as error:
        name = module.partition(".")[0]
        raise ImportError(f'{name} is needed: pip install "{package}"') from error
