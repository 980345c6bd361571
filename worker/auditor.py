"""The auditor: makes audits in a process of its own, so that replays need not wait for them.

The first audit imports the engine; until then this process needs little memory.
"""

from operator import attrgetter

from .process_setup import log_to_stderr
from .renderer import serve_queue

if __name__ == "__main__":
    log_to_stderr()
    serve_queue("auditor", attrgetter("audits"))
