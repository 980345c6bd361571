"""Wrong tokens, counted by where they come from: whoever guesses is told to wait."""

import time
from collections import OrderedDict
from collections.abc import Callable
from ipaddress import IPv6Address, ip_address, ip_network
from math import ceil
from threading import Lock

AT_ONCE = 10
"""Wrong tokens that an address may send in a row."""
EVERY = 6.0
"""Seconds after which it may send one more."""
ADDRESSES = 4096
"""So many are remembered, those that were heard of last."""


class Guesses:
    """When each address has made up for its wrong tokens: each costs it `EVERY` seconds."""

    def __init__(self, clock: Callable[[], float] = time.monotonic):
        self._clock, self._lock = clock, Lock()
        self._paid = OrderedDict[str, float]()

    def add(self, address: str) -> int:
        """Count one; seconds to wait before the next, 0 while there were few."""
        whose = household(address)
        with self._lock:
            now = self._clock()
            paid = max(now, self._paid.pop(whose, now))
            wait = max(0, ceil(paid + EVERY - now - AT_ONCE * EVERY))
            # Whoever does not wait is refused again, but waits no longer for it.
            self._paid[whose] = paid if wait else paid + EVERY
            if len(self._paid) > ADDRESSES:
                self._paid.popitem(last=False)
        return wait


def household(address: str) -> str:
    """An address, of IPv6 the network in which one may have as many as one likes.

    Whatever else a proxy may call itself counts as one.
    """
    try:
        found = ip_address(address.partition("%")[0])
    except ValueError:
        return "somebody"
    if isinstance(found, IPv6Address) and not found.ipv4_mapped:
        return str(ip_network((found, 64), strict=False))
    return str(getattr(found, "ipv4_mapped", None) or found)
