"""`python -m server.auth`: create, list and revoke tokens on the server's own machine."""

import argparse
import sys
from datetime import datetime

from sqlalchemy import select

from microcosmos.client.sharing import expiry

from ..core.errors import ProblemError
from ..services.services import Services, connect
from ..settings import Settings
from ..tables import Token, migrations
from ..tables.tokens import SCOPES
from . import tokens


def main(words: list[str] | None = None) -> None:
    arguments = _arguments().parse_args(words)
    services = connect(Settings())
    try:
        migrations.upgrade(services.sessions)
        arguments.act(services, arguments)
    except ProblemError as error:
        sys.exit(error.problem.detail)
    finally:
        services.close()


def _arguments() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m server.auth", description=__doc__)
    actions = parser.add_subparsers(required=True, metavar="create | list | revoke")
    create = actions.add_parser("create", help="create a token; its secret is shown once")
    create.add_argument("name")
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
            print(f"{token.name}\t{token.scope}\t{token.prefix}…\t{ended}{until}")


def _revoke(services: Services, arguments: argparse.Namespace) -> None:
    """Revoke a token, even the last admin token: this command can create another."""
    live = select(Token.id).where(Token.name == arguments.name, Token.revoked_at.is_(None))
    with services.sessions.read() as session:
        token = session.scalars(live).one_or_none()
    if token is None:
        raise ProblemError(404, "Not found", f"No live token is named {arguments.name!r}.")
    tokens.revoke(services, token, last=True)


if __name__ == "__main__":
    main()
