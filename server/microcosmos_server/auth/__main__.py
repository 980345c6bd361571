"""`python -m microcosmos_server.auth`: create, list and revoke tokens on this machine."""

import argparse
import sys
from contextlib import closing
from datetime import datetime

from pydantic import TypeAdapter, ValidationError
from sqlalchemy import select
from sqlalchemy.exc import SQLAlchemyError

from microcosmos.client.formatting import visible
from microcosmos.client.sharing import expiry

from ..core.errors import DomainError, NotFound
from ..services.services import Services, connect
from ..settings import from_environment
from ..tables import Token, migrations
from ..tables.installation import SCOPES
from . import tokens


def main(words: list[str] | None = None) -> None:
    arguments = _arguments().parse_args(words)
    settings = from_environment()
    # A mistyped folder is not made; only the first token may come before the first start.
    file = settings.database_file
    if arguments.act is not _create and file and not file.exists():
        sys.exit(f"`data` must be the folder of an installation; there is no {file}")
    try:
        with closing(connect(settings)) as services:
            migrations.upgrade(services.sessions)
            arguments.act(services, arguments)
    except DomainError as error:
        sys.exit(error.problem.detail)
    except migrations.SchemaError as error:
        sys.exit(str(error))
    except (SQLAlchemyError, OSError) as error:
        sys.exit(f"The database does not answer: {getattr(error, 'orig', None) or error}")


def _arguments() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m microcosmos_server.auth", description=__doc__
    )
    actions = parser.add_subparsers(required=True, metavar="create | list | revoke")
    create = actions.add_parser("create", help="create a token; its secret is shown once")
    create.add_argument("name", type=_name)
    create.add_argument("--scope", choices=SCOPES, default="read")
    create.add_argument(
        "--days", type=_end, dest="end", help="days until it expires (default: never)"
    )
    create.set_defaults(act=_create)
    actions.add_parser("list", help="list all tokens").set_defaults(act=_list)
    revoke = actions.add_parser("revoke", help="revoke a token now")
    revoke.add_argument("name")
    revoke.set_defaults(act=_revoke)
    return parser


def _create(services: Services, arguments: argparse.Namespace) -> None:
    print(tokens.create(services, arguments.name, arguments.scope, arguments.end).secret)


def _name(text: str) -> str:
    try:
        return TypeAdapter(tokens.Name).validate_python(text)
    except ValidationError:
        needed = f"`name` must have 1 to 64 characters in UTF-8; got {text!r}"
        raise argparse.ArgumentTypeError(needed) from None


def _end(days: str) -> datetime:
    try:
        return datetime.fromisoformat(expiry(float(days)))
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def _list(services: Services, arguments: argparse.Namespace) -> None:
    with services.sessions.read() as session:
        for token in tokens.all_tokens(session):
            ended = f"revoked {token.revoked_at:%Y-%m-%d}" if token.revoked_at else "live"
            until = f", until {token.expires_at:%Y-%m-%d %H:%M}" if token.expires_at else ""
            print(f"{visible(token.name)}\t{token.scope}\t{token.prefix}…\t{ended}{until}")


def _revoke(services: Services, arguments: argparse.Namespace) -> None:
    """Revoke a token, even the last admin token: this command can create another."""
    live = select(Token.id).where(Token.name == arguments.name, Token.revoked_at.is_(None))
    with services.sessions.read() as session:
        token = session.scalars(live).one_or_none()
    if token is None:
        raise NotFound(f"No live token is named {arguments.name!r}.")
    tokens.revoke(services, token, last=True)


if __name__ == "__main__":
    main()
