"""Rate limit: count wrong tokens by address."""

import time
from collections import OrderedDict
from collections.abc import Callable
from ipaddress import IPv6Address, ip_address, ip_network
from math import ceil
from threading import Lock

BURST = 10
"""Wrong tokens that an address may send in a row."""
INTERVAL = 6.0
"""Seconds after which it may send one more."""
ADDRESSES = 4096
"""Addresses that are remembered, those of the latest requests."""


class RateLimit:
    """Remembers when each address may send the next wrong token."""

    def __init__(self, clock: Callable[[], float] = time.monotonic):
        self._clock, self._lock = clock, Lock()
        self._charged_until = OrderedDict[str, float]()

    def add(self, address: str) -> int:
        """Count a wrong token; return the seconds to wait before the next one."""
        network = network_of(address)
        with self._lock:
            now = self._clock()
            charged = max(now, self._charged_until.pop(network, now))
            wait = max(0, ceil(charged + INTERVAL - now - BURST * INTERVAL))
            # A refused attempt does not make the wait longer.
            self._charged_until[network] = charged if wait else charged + INTERVAL
            if len(self._charged_until) > ADDRESSES:
                self._charged_until.popitem(last=False)
        return wait


def network_of(address: str) -> str:
    """Return the IPv4 address, or the IPv6 network, since one host may use all of a network.

    Everything else counts as one address.
    """
    try:
        found = ip_address(address.partition("%")[0])
    except ValueError:
        return "unknown"
    if isinstance(found, IPv6Address) and not found.ipv4_mapped:
        return str(ip_network((found, 64), strict=False))
    return str(getattr(found, "ipv4_mapped", None) or found)
