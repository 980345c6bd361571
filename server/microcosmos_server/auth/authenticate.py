"""Authenticate a request by its token, and limit the rate of unknown tokens by address."""

import time
from collections import OrderedDict
from collections.abc import Callable
from hmac import compare_digest
from ipaddress import IPv6Address, ip_address, ip_network
from math import ceil
from threading import Lock

from ..core.errors import DomainError, TooMany, Unauthorized
from ..services.services import Services
from . import tokens
from .principal import ENVIRONMENT, LOCAL, Principal

TOKEN_NEEDED = "A token is needed: send it as `Authorization: Bearer`, or sign in at /settings."
BURST = 10
"""Wrong tokens that an address may send in a row."""
INTERVAL = 6.0
"""Seconds after which it may send one more."""
ADDRESSES = 4096
"""Addresses that are remembered, those of the latest requests."""


class RateLimit:
    """Remembers when each address may send the next wrong token.

    Each of several processes allows its part of the rate, so that all allow no more than one.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic, processes: int = 1):
        # Threads answer requests, so several may count at once.
        self._clock, self._lock = clock, Lock()
        self._burst, self._interval = max(1, BURST // processes), INTERVAL * processes
        self._charged_until = OrderedDict[str, float]()

    def add(self, address: str) -> int:
        """Count a wrong token; return the seconds to wait before the next one."""
        network = network_of(address)
        with self._lock:
            now = self._clock()
            charged = max(now, self._charged_until.pop(network, now))
            allowed = self._burst * self._interval
            wait = max(0, ceil(charged + self._interval - now - allowed))
            # A refused attempt does not make the wait longer.
            self._charged_until[network] = charged if wait else charged + self._interval
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


class Authenticator:
    """Identifies principals. The rate limit never delays a valid token."""

    def __init__(self, services: Services):
        self.services = services
        self.limit = RateLimit(processes=services.settings.servers)

    def identify(self, token: str | None) -> Principal:
        """Return the principal; raise `DomainError` where a token is needed or not valid."""
        settings = self.services.settings
        if not token:
            if settings.needs_token:
                raise Unauthorized(TOKEN_NEEDED, headers=tokens.CHALLENGE)
            return LOCAL
        set_token = settings.token.get_secret_value() if settings.token else ""
        # The time of the comparison must not tell how much of a guess is right.
        if set_token and compare_digest(token.encode(), set_token.encode()):
            return ENVIRONMENT
        return tokens.principal_of(self.services, token)

    def reject(self, error: DomainError, address: str) -> DomainError:
        """Count an unknown token; return the error to answer, 429 where there were many."""
        wait = self.limit.add(address) if isinstance(error, tokens.UnknownToken) else 0
        if not wait:
            return error
        detail = (
            "This server does not know the token, and your address has sent many unknown ones. "
            f"Try again in {wait} s. A valid token is accepted at once."
        )
        headers = {"Retry-After": str(wait)}
        return TooMany(detail, title="Too many wrong tokens", headers=headers)
