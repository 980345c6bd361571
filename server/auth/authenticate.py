"""Authenticate a request: find the principal of its token, and slow down guessing."""

from dataclasses import dataclass
from hmac import compare_digest

from ..core.errors import ProblemError
from ..services.services import Services
from . import tokens
from .principal import ENVIRONMENT, LOCAL, Principal
from .ratelimit import RateLimit

TOKEN_NEEDED = "A token is needed: send it as `Authorization: Bearer`, or sign in at /settings."


@dataclass(frozen=True)
class Credentials:
    """The token of a request, if any, and the address that it came from."""

    token: str | None
    address: str


class Authenticator:
    """Identifies principals. The rate limit never delays a valid token."""

    def __init__(self, services: Services):
        self.services, self.limit = services, RateLimit()

    def identify(self, credentials: Credentials) -> Principal:
        """Return the principal; raise `ProblemError` where a token is needed or not valid."""
        settings, token = self.services.settings, credentials.token
        if not token:
            if settings.needs_token:
                raise ProblemError(401, "Unauthorized", TOKEN_NEEDED, headers=tokens.CHALLENGE)
            return LOCAL
        set_token = settings.token.get_secret_value() if settings.token else ""
        if set_token and compare_digest(token.encode(), set_token.encode()):
            return ENVIRONMENT
        return tokens.principal_of(self.services, token)

    def count(self, error: ProblemError, address: str) -> ProblemError:
        """Count an unknown token; return the error to answer, 429 where there were many."""
        wait = self.limit.add(address) if isinstance(error, tokens.UnknownToken) else 0
        return _too_many(wait) if wait else error


def _too_many(wait: int) -> ProblemError:
    detail = (
        "This server does not know the token, and your address has sent many unknown ones. "
        f"Try again in {wait} s. A valid token is accepted at once."
    )
    headers = {"Retry-After": str(wait)}
    return ProblemError(429, "Too many wrong tokens", detail, headers=headers)
