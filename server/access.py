"""Whether whoever asks may have what they ask for."""

from hmac import compare_digest
from typing import Any

from sqlalchemy import inspect

from . import owners, tokens
from .caller import ADMIN, LOCAL, NOBODY, SETTING, WRITE, Caller
from .needs import OWNED, OWNER, PUBLIC, Need
from .problems import Refused
from .services import Services

SHOW = "A token is needed, as `Authorization: Bearer` or by signing in at /settings."


def identify(services: Services, given: str | None) -> Caller:
    """Who sent a token, or none; `Refused` where it is wrong, or one is needed."""
    settings = services.settings
    if not given:
        if settings.needs_token:
            raise Refused(401, "Unauthorized", SHOW, headers={"WWW-Authenticate": "Bearer"})
        return LOCAL
    set_token = settings.token.get_secret_value() if settings.token else ""
    if set_token and compare_digest(given.encode(), set_token.encode()):
        return SETTING
    return tokens.holder(services, given)


def admit(services: Services, given: str | None, need: Need) -> Caller:
    """Whoever sent a token, if they may what needs this; `Refused` says what they lack."""
    if need.need == PUBLIC:
        return NOBODY
    caller = identify(services, given)
    scope = WRITE if need.need == OWNER else need.need
    if not caller.may(scope):
        detail = f"This needs a token of scope `{scope}`; `{caller.name}` has `{caller.scope}`."
        raise Refused(403, "Forbidden", detail)
    if need.need == OWNER and not caller.may(ADMIN):
        _refuse_other(services, caller, need.parameters)
    return caller


def _refuse_other(services: Services, caller: Caller, parameters: dict[str, str]) -> None:
    """Refuse whoever does not own what a path names; where nothing is there, let it be said."""
    (name,) = parameters.keys() & OWNED.keys() or (None,)
    if name is None:
        detail = "Only an admin may do this: whose it is is not known."
        raise Refused(403, "Forbidden", detail)
    table = OWNED[name]
    key = _key(table, parameters[name])
    with services.sessions.read() as session:
        row = session.get(table, key) if key is not None else None
        if row is None or row.owner == caller.token:
            return
        owner = owners.names(session, [row.owner]).get(row.owner)
    whose = f"belongs to `{owner}`" if owner else "was made without a token"
    detail = (
        f"The {table.__name__.lower()} {parameters[name]} {whose}: only "
        f"{'its owner or ' if owner else ''}an admin may change it; you are `{caller.name}`."
    )
    raise Refused(403, "Forbidden", detail)


def _key(table: type[Any], text: str) -> Any:
    """The primary key that a path holds; None where it cannot be one."""
    try:
        return inspect(table).primary_key[0].type.python_type(text)
    except ValueError:
        return None
