"""Make audits, beside the renderer: they take minutes, and replays must not wait for them.

The engine is imported with the first audit; until then this process needs little memory.
"""

from operator import attrgetter

from .process import log_to_stderr
from .renderer import serve

if __name__ == "__main__":
    log_to_stderr()
    serve("auditor", attrgetter("audits"))
