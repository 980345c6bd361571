"""Commands for imports, shares and tokens."""

from typing import Annotated, Any
from urllib.parse import urlsplit

import typer
from typer import Argument, Option

from ..client import Client
from ..client.connection import LOOPBACK
from .app import app, say
from .remote import SHARING, Ids, Json, server_command, show, show_table

tokens = typer.Typer(help="Create, list and revoke access tokens.", no_args_is_help=True)
app.add_typer(tokens, name="tokens", rich_help_panel=SHARING)

Days = Annotated[float | None, Option(help="Days until it expires; default: never.")]


@server_command(SHARING, "import")
def import_(
    client: Client,
    files: Annotated[
        list[str],
        Argument(metavar="FILE|URL...", help="Creature files, or addresses of shares."),
    ],
    every: Annotated[
        bool,
        Option("--all", help="Import all creatures of shared archives, without ancestors."),
    ] = False,
) -> None:
    """Import creatures from files or shares into a server, which verifies their hashes."""
    for file in files:
        for one in client.import_all(file) if every else [client.import_creature(file)]:
            # At once: an interrupted import shows what has arrived.
            print(one.sha, flush=True)


@server_command(SHARING)
def share(
    client: Client,
    what: Annotated[
        str, Argument(metavar="SHA|RUN", help="Name of a creature (SHA-256), or id of a run.")
    ],
    generation: Annotated[
        int | None, Option(min=0, help="Publish the archive of the run after this generation.")
    ] = None,
    days: Days = None,
    title: Annotated[str | None, Option(help="Title of the shared page.")] = None,
    credit: Annotated[str | None, Option(help="Authors to credit.")] = None,
    licence: Annotated[str | None, Option(help="Licence, such as CC-BY-4.0.")] = None,
    listed: Annotated[bool, Option("--listed", help="List it in the commons.")] = False,
    json: Json = False,
) -> None:
    """Publish a creature or an archive; people without a token can open the link."""
    texts = {"title": title, "credit": credit, "licence": licence}
    made = client.share(what, generation=generation, listed=listed, days=days, **texts)
    if json:
        show(made.record)
        return
    print(made.url)
    if urlsplit(made.url).hostname in LOOPBACK:
        say(
            "Nobody else can open this link: set MICROCOSMOS_PUBLIC_URL on the server.",
            "yellow",
        )
    say(f"To revoke it: microcosmos unshare {made.slug}")


@server_command(SHARING)
def unshare(
    client: Client,
    slugs: Annotated[list[str], Argument(metavar="LINK...", help="Links or slugs.")],
) -> None:
    """Revoke shares."""
    for slug in slugs:
        client.unshare(slug)
        say(f"{slug} is revoked.")


@server_command(SHARING)
def shares(client: Client, json: Json = False) -> None:
    """List your shares."""
    published = client.shares()
    links = [{**one.record, "link": one.url} for one in published]
    _list(
        [one.record for one in published] if json else links,
        json,
        "link title state expires_at",
    )


@server_command(None, "create", tokens)
def create_token(
    client: Client,
    name: Annotated[str, Argument(help="Owner or purpose of the token.")],
    scope: Annotated[
        str,
        Option(
            help="read, write (also create runs and change your own), or admin (everything)."
        ),
    ] = "read",
    days: Days = None,
    json: Json = False,
) -> None:
    """Create a token. Its secret is shown only once."""
    made = client.create_token(name, scope, days=days)
    if json:
        show(made)
        return
    print(made["secret"])
    say("The secret is shown only once. To use it: export MICROCOSMOS_TOKEN=...")


@server_command(None, "list", tokens)
def list_tokens(client: Client, json: Json = False) -> None:
    """List all tokens, without their secrets."""
    _list(client.tokens(), json, "id name scope expires_at revoked_at last_used_at")


@server_command(None, "revoke", tokens)
def revoke_token(client: Client, ids: Ids) -> None:
    """Revoke tokens; they stop working immediately."""
    for id in ids:
        client.revoke_token(id)
        say(f"Token {id} is revoked.")


def _list(records: list[dict[str, Any]], json: bool, fields: str) -> None:
    if json:
        show(records)
        return
    names = fields.split()
    short = [{**one, "id": str(one.get("id"))[:8]} for one in records]
    rows = [[one.get(name) for name in names] for one in short]
    show_table([name.removesuffix("_at") for name in names], rows)
