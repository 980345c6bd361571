"""The page of a share, with the tags from which other sites make a preview."""

import logging
import re
from html import escape

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse, Response
from redis import RedisError
from sqlalchemy import func, select
from sqlalchemy.orm import Session

from microcosmos.archive.measured import of_creature
from microcosmos.viz.film import FILM, PICTURE

from ..archives import elites
from ..core import static_files
from ..core.errors import DomainError
from ..core.security_headers import POLICY
from ..renderings import storage as renderings
from ..services.services import Services, ServicesDep
from ..tables import LOOP, PREVIEW, Creature, Run, Share
from .access import SLUG, find_live

log = logging.getLogger(__name__)


def order_previews(services: Services, cover: str, *, anonymous: bool = False) -> None:
    """Enqueue the missing picture and film, the picture first; no request waits."""
    with services.sessions.read() as session:
        missing = [
            kind for kind in (PREVIEW, LOOP) if renderings.find(session, cover, kind) is None
        ]
    try:
        for kind in missing:
            renderings.enqueue(services, cover, kind, anonymous=anonymous)
    except (RedisError, renderings.RenderingFailed) as error:
        # The share itself is published: a picture is not worth an error.
        log.warning("The preview of %s is left to its next visitor: %s", cover, error)


ADDRESS = re.compile(
    r"(?P<server>https?://[a-zA-Z0-9.-]+(:[0-9]{1,5})?(/[a-zA-Z0-9._~-]+)*)"
    rf"/s/(?P<slug>{SLUG.pattern})(/creatures/[0-9a-f]{{64}})?/?"
)
"""The address of a share, or of a creature in one, made of characters without a meaning in a
Content Security Policy."""

EMBEDDABLE = POLICY.replace("frame-ancestors 'none'", "frame-ancestors *")

router = APIRouter(include_in_schema=False)


@router.get("/import")
def read_import_page(share: str = "") -> Response:
    """Return the page that imports from an address; it may request that share's files alone."""
    index = static_files.BUILT / "index.html"
    if not index.is_file():
        return HTMLResponse(static_files.MISSING, 503)
    found = ADDRESS.fullmatch(share)
    headers = dict(static_files.FRESH)
    if found:
        under = f"{found['server']}/api/v1/shares/{found['slug']}"
        files = f"{under}/creature.json {under}/creatures.json"
        headers["Content-Security-Policy"] = f"{POLICY}; connect-src 'self' {files}"
    return HTMLResponse(index.read_text(), headers=headers)


@router.get("/s/{slug}")
@router.get("/s/{slug}/{rest:path}")
def read_share_page(
    request: Request, slug: str, services: ServicesDep, rest: str = ""
) -> Response:
    """Return the page itself, which explains a missing, expired or revoked share.

    Other sites may show `embed` in a frame: it has nothing to click but a link and a player.
    """
    if not (static_files.BUILT / "index.html").is_file():
        return HTMLResponse(static_files.MISSING, 503)
    index = (static_files.BUILT / "index.html").read_text()
    headers = {"Content-Security-Policy": EMBEDDABLE} if rest == "embed" else None
    try:
        with services.sessions.read() as session:
            share = find_live(session, slug)
            has_film = renderings.find(session, share.cover, LOOP) is not None
            about = description(session, share)
    except DomainError as error:
        return HTMLResponse(index, error.problem.status, headers=headers)
    request.state.listed = share.listed
    order_previews(services, share.cover, anonymous=True)
    found = tags(public_address(request), share, about, has_film)
    return HTMLResponse(with_tags(index, found), headers=headers)


def public_address(request: Request) -> str:
    """Return the public address of this server, without a slash at the end."""
    given = request.app.state.services.settings.public_url
    return (given or str(request.base_url)).rstrip("/")


def description(session: Session, share: Share) -> str:
    by = f" By {', '.join(share.credit)}." if share.credit else ""
    licence = f" {share.licence}." if len(share.licence) <= 40 else ""
    if share.run_id:
        run = session.get_one(Run, share.run_id)
        archive = elites.as_of(run, share.generation or 0).order_by(None).subquery()
        count = session.scalars(select(func.count()).select_from(archive)).one()
        text = f"An archive of {count:,} swimmers after {share.generation:,} generations."
    else:
        text = creature_description(session.get_one(Creature, share.cover))
    return text + by + licence


def creature_description(creature: Creature) -> str:
    """Describe a creature with its measured length and distance."""
    measures = of_creature(creature.measured)
    length, distance = measures.get("total_length"), measures.get("displacement")
    if distance is None:
        return "A creature of Microcosmos."
    scale = "" if length is None else f", {length:.3g} cells long,"
    return f"An evolved swimmer{scale} that travels {distance:.3g} cells."


def tags(base: str, share: Share, description: str, has_film: bool) -> dict[str, str]:
    """Return the names and contents of Open Graph's and Twitter's tags."""
    files = f"{base}/api/v1/shares/{share.slug}"
    picture = f"{files}/{PREVIEW}"
    film = {
        "og:video": f"{files}/{LOOP}",
        "og:video:type": "video/mp4",
        "og:video:width": str(FILM[0]),
        "og:video:height": str(FILM[1]),
    }
    return {
        "og:site_name": "Microcosmos",
        "og:type": "website",
        "og:url": f"{base}/s/{share.slug}",
        "og:title": share.title,
        "og:description": description,
        "og:image": picture,
        "og:image:type": "image/png",
        "og:image:width": str(PICTURE[0]),
        "og:image:height": str(PICTURE[1]),
        "og:image:alt": f"{share.title}: a swimmer over the flow that it makes",
        **(film if has_film else {}),
        "twitter:card": "summary_large_image",
        "twitter:title": share.title,
        "twitter:description": description,
        "twitter:image": picture,
    }


def with_tags(index: str, tags: dict[str, str]) -> str:
    """Return the page's document with tags in its head; text from people is escaped."""
    lines = [
        f'<meta {"name" if name.startswith("twitter") else "property"}="{name}" '
        f'content="{escape(value)}" />'
        for name, value in tags.items()
    ]
    lines.append(f'<link rel="canonical" href="{escape(tags["og:url"])}" />')
    title = f"<title>{escape(tags['og:title'])} · Microcosmos</title>"
    index = index.replace("<title>Microcosmos</title>", title, 1)
    before, _, after = index.partition("</head>")
    return "\n".join([before.rstrip(), *lines, "</head>"]) + after
