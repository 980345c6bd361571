"""Whether whoever asks may have what they ask for."""

from dataclasses import dataclass
from hmac import compare_digest
from typing import Any

from sqlalchemy import inspect
from sqlalchemy.orm import Session

from ..core.errors import ProblemError
from ..services.services import Services
from ..tables import Owned
from . import owners, tokens
from .principal import ADMIN, ANONYMOUS, ENVIRONMENT, LOCAL, WRITE, Principal
from .ratelimit import Guesses
from .scopes import OWNED, OWNER, PUBLIC, Need

SHOW = "A token is needed, as `Authorization: Bearer` or by signing in at /settings."


@dataclass(frozen=True)
class Shown:
    """A token, if any, and the address that it came from."""

    token: str | None
    address: str


class Door:
    """Where tokens are shown. Good ones are let in however many wrong ones come beside them."""

    def __init__(self, services: Services):
        self.services, self.guesses = services, Guesses()

    def admit(self, shown: Shown, need: Need) -> Principal:
        """Return the principal; raise `ProblemError` where it may not do this."""
        if need.need == PUBLIC:
            return ANONYMOUS
        caller = self.identify(shown)
        scope = WRITE if need.need == OWNER else need.need
        if not caller.may(scope):
            detail = (
                f"This needs a token of scope `{scope}`; `{caller.name}` has `{caller.scope}`."
            )
            raise ProblemError(403, "Forbidden", detail)
        if need.need == OWNER and not caller.may(ADMIN):
            _refuse_other(self.services, caller, need.parameters)
        return caller

    def identify(self, shown: Shown) -> Principal:
        """Who shows a token, or none; `ProblemError` where it is wrong, or one is needed."""
        try:
            return _holder(self.services, shown.token)
        except tokens.Wrong:
            if wait := self.guesses.add(shown.address):
                raise _too_many(wait) from None
            raise


def _holder(services: Services, token: str | None) -> Principal:
    settings = services.settings
    if not token:
        if settings.needs_token:
            raise ProblemError(401, "Unauthorized", SHOW, headers=tokens.CHALLENGE)
        return LOCAL
    set_token = settings.token.get_secret_value() if settings.token else ""
    if set_token and compare_digest(token.encode(), set_token.encode()):
        return ENVIRONMENT
    return tokens.holder(services, token)


def _too_many(wait: int) -> ProblemError:
    detail = (
        f"The token that was sent is none of this server's, and many such came from your "
        f"address: try the next one in {wait} s. A good one need not wait."
    )
    headers = {"Retry-After": str(wait)}
    return ProblemError(429, "Too many wrong tokens", detail, headers=headers)


def _refuse_other(services: Services, caller: Principal, parameters: dict[str, str]) -> None:
    """Refuse whoever does not own what a path names; where nothing is there, let it be said."""
    (name,) = parameters.keys() & OWNED.keys() or (None,)
    if name is None:
        detail = "Only an admin may do this: whose it is is not known."
        raise ProblemError(403, "Forbidden", detail)
    key = _key(OWNED[name], parameters[name])
    with services.sessions.read() as session:
        row = session.get(OWNED[name], key) if key is not None else None
        if row is not None:
            refuse_other(session, caller, row, "change")


def refuse_other(session: Session, caller: Principal, row: Owned, deed: str) -> None:
    """Raise `ProblemError` unless the principal owns the row or is an admin."""
    if caller.may(ADMIN) or row.owner == caller.token:
        return
    owner = owners.names(session, [row.owner]).get(row.owner)
    whose = f"belongs to `{owner}`" if owner else "was made without a token"
    (key,) = inspect(row).identity
    detail = (
        f"The {type(row).__name__.lower()} {key} {whose}: only "
        f"{'its owner or ' if owner else ''}an admin may {deed} it; you are `{caller.name}`."
    )
    raise ProblemError(403, "Forbidden", detail)


def _key(table: type[Any], text: str) -> Any:
    """The primary key that a path holds; None where it cannot be one."""
    if "\0" in text:  # PostgreSQL reads no such text.
        return None
    try:
        return inspect(table).primary_key[0].type.python_type(text)
    except ValueError:
        return None
