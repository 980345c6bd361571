"""Makes audits: they take minutes, and nobody who wants to watch has to wait for them.

The engine is imported with the first one: until then this process needs little memory.
"""

from operator import attrgetter

from . import log
from .renderer import serve

if __name__ == "__main__":
    log.begin()
    serve("auditor", attrgetter("audits"))
