"""Commands for imports, shares and tokens."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from .app import app
from .remote import SHARING, Json, Token, Url, reaching, say, show
from .tables import shown

tokens = typer.Typer(help="Create, list and revoke access tokens.", no_args_is_help=True)
app.add_typer(tokens, name="tokens", rich_help_panel=SHARING)

Days = Annotated[float | None, typer.Option(help="Days until it expires; default: never.")]


@app.command("import", rich_help_panel=SHARING)
def bring(
    files: Annotated[list[Path], typer.Argument(exists=True, dir_okay=False)],
    url: Url = None,
    token: Token = None,
) -> None:
    """Import creature files into a server, which verifies their hashes."""
    with reaching(url, token) as client:
        for file in files:
            print(client.import_creature(file).sha)


@app.command(rich_help_panel=SHARING)
def share(
    what: Annotated[
        str,
        typer.Argument(metavar="SHA|RUN", help="Name of a creature (SHA-256), or id of a run."),
    ],
    generation: Annotated[
        int | None,
        typer.Option(min=0, help="Publish the archive of the run after this generation."),
    ] = None,
    days: Days = None,
    title: Annotated[str | None, typer.Option(help="Title of the shared page.")] = None,
    credit: Annotated[str | None, typer.Option(help="Authors to credit.")] = None,
    licence: Annotated[str | None, typer.Option(help="Licence, such as CC-BY-4.0.")] = None,
    listed: Annotated[bool, typer.Option("--listed", help="List it in the commons.")] = False,
    json: Json = False,
    url: Url = None,
    token: Token = None,
) -> None:
    """Publish a creature or an archive; people without a token can open the link."""
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
    slugs: Annotated[list[str], typer.Argument(metavar="LINK...", help="Links or slugs.")],
    url: Url = None,
    token: Token = None,
) -> None:
    """Revoke shares."""
    with reaching(url, token) as client:
        for slug in slugs:
            client.unshare(slug)
            say(f"{slug} is revoked.")


@app.command(rich_help_panel=SHARING)
def shares(json: Json = False, url: Url = None, token: Token = None) -> None:
    """List your shares."""
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
    name: Annotated[str, typer.Argument(help="Owner or purpose of the token.")],
    scope: Annotated[
        str,
        typer.Option(
            help="read, write (also create runs and change your own), or admin (everything)."
        ),
    ] = "write",
    days: Days = None,
    json: Json = False,
    url: Url = None,
    token: Token = None,
) -> None:
    """Create a token. Its secret is shown only once."""
    with reaching(url, token) as client:
        made = client.create_token(name, scope, days=days)
    if json:
        show(made)
        return
    print(made["secret"])
    say("The secret is shown only once. To use it: export MICROCOSMOS_TOKEN=...")


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
    ids: Annotated[
        list[str],
        typer.Argument(metavar="ID...", help="Ids; their first characters are enough."),
    ],
    url: Url = None,
    token: Token = None,
) -> None:
    """Revoke tokens; they stop working immediately."""
    with reaching(url, token) as client:
        for id in ids:
            client.revoke_token(id)
            say(f"Token {id} is revoked.")


def _titles(fields: Sequence[str]) -> list[str]:
    return [name.removesuffix("_at") for name in fields]
