"""What is shared with others: creatures brought, links, tokens."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from .app import app
from .remote import SHARING, Json, Token, Url, reaching, say, show
from .tables import shown

tokens = typer.Typer(help="Who may use the server.", no_args_is_help=True)
app.add_typer(tokens, name="tokens", rich_help_panel=SHARING)

Days = Annotated[float | None, typer.Option(help="It expires after so many.")]


@app.command("import", rich_help_panel=SHARING)
def bring(
    files: Annotated[list[Path], typer.Argument(exists=True, dir_okay=False)],
    url: Url = None,
    token: Token = None,
) -> None:
    """Bring creature files to a server, their hashes verified."""
    with reaching(url, token) as client:
        for file in files:
            print(client.import_creature(file).sha)


@app.command(rich_help_panel=SHARING)
def share(
    what: Annotated[str, typer.Argument(metavar="SHA|RUN", help="A creature, or a run's id.")],
    generation: Annotated[
        int | None, typer.Option(min=0, help="The run's archive as it was then.")
    ] = None,
    days: Days = None,
    title: Annotated[str | None, typer.Option(help="What others read above it.")] = None,
    credit: Annotated[str | None, typer.Option(help="Whose it is.")] = None,
    licence: Annotated[str | None, typer.Option(help="What others may do with it.")] = None,
    listed: Annotated[bool, typer.Option("--listed", help="In the commons, too.")] = False,
    json: Json = False,
    url: Url = None,
    token: Token = None,
) -> None:
    """Publish a creature or an archive under a link, for people without a token."""
    said = {"days": days, "title": title, "credit": credit, "licence": licence}
    if generation is not None:
        said |= {"generation": generation}
    with reaching(url, token) as client:
        made = client.share(what, listed=listed, **said)
        if json:
            show(made.record)
            return
        print(made.url)
        say(f"To revoke it: microcosmos unshare {made.slug}")


@app.command(rich_help_panel=SHARING)
def unshare(
    slugs: Annotated[list[str], typer.Argument(metavar="LINK...", help="Links, or slugs.")],
    url: Url = None,
    token: Token = None,
) -> None:
    """Revoke links."""
    with reaching(url, token) as client:
        for slug in slugs:
            client.unshare(slug)
            say(f"{slug} leads nowhere now.")


@app.command(rich_help_panel=SHARING)
def shares(json: Json = False, url: Url = None, token: Token = None) -> None:
    """List your links."""
    with reaching(url, token) as client:
        found = client.shares()
    if json:
        show([one.record for one in found])
        return
    names = ("title", "state", "expires_at")
    rows = ((one.url, *(one.record.get(name) for name in names)) for one in found)
    shown(("link", *_titles(names)), rows)


@tokens.command("create")
def create_token(
    name: Annotated[str, typer.Argument(help="Whose it is, or what it is for.")],
    scope: Annotated[
        str, typer.Option(help="read; write: also one's own; admin: everything.")
    ] = "write",
    days: Days = None,
    json: Json = False,
    url: Url = None,
    token: Token = None,
) -> None:
    """Make a token; its secret is shown this once."""
    with reaching(url, token) as client:
        made = client.create_token(name, scope, days=days)
    if json:
        show(made)
        return
    print(made["secret"])
    say("It is shown this once. To use it: export MICROCOSMOS_TOKEN=...")


@tokens.command("list")
def list_tokens(json: Json = False, url: Url = None, token: Token = None) -> None:
    """List all tokens, without their secrets."""
    with reaching(url, token) as client:
        found = client.tokens()
    if json:
        show(found)
        return
    names = ("id", "name", "scope", "expires_at", "revoked_at", "last_used_at")
    rows = ((one["id"][:8], *(one.get(name) for name in names[1:])) for one in found)
    shown(_titles(names), rows)


@tokens.command("revoke")
def revoke_token(
    ids: Annotated[list[str], typer.Argument(metavar="ID...", help="Ids, or beginnings.")],
    url: Url = None,
    token: Token = None,
) -> None:
    """Revoke tokens at once."""
    with reaching(url, token) as client:
        for id in ids:
            client.revoke_token(id)
            say(f"Token {id} is revoked.")


def _titles(fields: Sequence[str]) -> list[str]:
    return [name.removesuffix("_at") for name in fields]
