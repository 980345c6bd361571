"""The page at the address of a share, with what other sites show of it."""

from html import escape
from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse, Response
from sqlalchemy.orm import Session

from ..core import page
from ..core.errors import ProblemError
from ..services.deps import SessionDep
from ..tables import Creature, Share
from . import publishing
from .routes import base

WIDTH, HEIGHT = 1200, 630
"""Of the preview: what most sites cut pictures to."""

router = APIRouter(include_in_schema=False)


@router.get("/s/{slug}")
@router.get("/s/{slug}/{rest:path}")
def read_share_page(request: Request, slug: str, session: SessionDep) -> Response:
    """The page itself; it says in words why nothing is shared at an address any more."""
    if not (page.BUILT / "index.html").is_file():
        return HTMLResponse(page.MISSING, 503)
    index = (page.BUILT / "index.html").read_text()
    try:
        share = publishing.opened(session, slug)
    except ProblemError as error:
        return HTMLResponse(index, error.problem.status)
    request.state.listed = share.listed
    return HTMLResponse(with_tags(index, tags(base(request), share, described(session, share))))


def described(session: Session, share: Share) -> str:
    """What was shared, in a sentence or two."""
    by = f" By {', '.join(share.credit)}." if share.credit else ""
    licence = f" {share.licence}." if len(share.licence) <= 40 else ""
    if share.run_id:
        count = publishing.elites(session, share)
        what = f"An archive of {count:,} swimmers after {share.generation:,} generations."
    else:
        what = _told(session.get_one(Creature, share.cover).measured)
    return what + by + licence


def _told(measured: dict[str, Any] | None) -> str:
    measures = (measured or {}).get("measures", {})
    if "displacement" not in measures:
        return "A creature of Microcosmos."
    return f"An evolved swimmer that goes {measures['displacement']:.3g} cells."


def tags(base: str, share: Share, description: str) -> dict[str, str]:
    """Open Graph's names for it, and those that start with `twitter`."""
    picture = f"{base}/api/v1/shares/{share.slug}/preview.png"
    return {
        "og:site_name": "Microcosmos",
        "og:type": "website",
        "og:url": f"{base}/s/{share.slug}",
        "og:title": share.title,
        "og:description": description,
        "og:image": picture,
        "og:image:type": "image/png",
        "og:image:width": str(WIDTH),
        "og:image:height": str(HEIGHT),
        "og:image:alt": f"{share.title}: a swimmer over the flow that it makes",
        "twitter:card": "summary_large_image",
        "twitter:title": share.title,
        "twitter:description": description,
        "twitter:image": picture,
    }


def with_tags(index: str, tags: dict[str, str]) -> str:
    """The page's own document, with tags in its head; all that people wrote is escaped."""
    told = [
        f'<meta {"name" if name.startswith("twitter") else "property"}="{name}" '
        f'content="{escape(value)}" />'
        for name, value in tags.items()
    ]
    told.append(f'<link rel="canonical" href="{escape(tags["og:url"])}" />')
    title = f"<title>{escape(tags['og:title'])} · Microcosmos</title>"
    before, _, after = index.replace("<title>Microcosmos</title>", title, 1).partition(
        "</head>"
    )
    return "\n".join([before.rstrip(), *told, "</head>"]) + after
