"""Commands load for half a second; Ctrl-C ends them meanwhile without a traceback."""

import signal
from importlib import import_module
from types import ModuleType


def load(module: str) -> ModuleType:
    """Import a module; Ctrl-C meanwhile ends the process, as it does without Python."""
    # A process in the background of a shell script ignores it, and goes on ignoring it.
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        return import_module(module)
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        return import_module(module)
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
