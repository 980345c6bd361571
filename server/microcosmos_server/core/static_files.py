"""Serve the built page and the built documentation."""

import gzip
import re
from functools import lru_cache
from mimetypes import guess_type
from pathlib import Path

from fastapi import APIRouter, Request
from fastapi.responses import FileResponse, HTMLResponse, RedirectResponse, Response
from starlette.exceptions import HTTPException

from .answers import accepts

ROOT = Path(__file__).parents[3]
BUILT = ROOT / "web" / "dist"
DOCUMENTATION = ROOT / "docs" / "_build"
MISSING = """<!doctype html><html lang="en"><title>Microcosmos</title>
<p>The page has not been built yet: <code>make</code> in the checkout builds it.
The API is at <a href="/api/v1/openapi.json">/api/v1</a>."""
IMMUTABLE = {"Cache-Control": "public, max-age=31536000, immutable"}
FRESH = {"Cache-Control": "no-cache"}

router = APIRouter(include_in_schema=False)


PAGES = re.compile(
    "|new|compare|workers|shares|commons|settings|import|sweeps/[^/]+"
    "|(runs|creatures)/[^/]+(/tree)?|s/.+"
)
"""Paths of the page (`web/src/store/router.ts`); on others it says that there is nothing."""


@router.get("/{path:path}")
def page(path: str, request: Request) -> Response:
    """Return a built file, else the page, which reads the path itself."""
    if path == "help":
        return RedirectResponse("/help/")  # Relative links need the slash.
    if path.startswith("help/"):
        if file := _file(DOCUMENTATION, path.removeprefix("help/") or "index.html"):
            return FileResponse(file, headers=FRESH)
        raise HTTPException(404, "The documentation has no such page. `make docs` builds it.")
    if path == "api" or (path.startswith(("api/", "assets/")) and not _file(BUILT, path)):
        raise HTTPException(404, f"There is nothing at /{path}")
    if file := _file(BUILT, path):
        if not path.startswith("assets/"):
            return FileResponse(file, headers=FRESH)
        # A script or a style, whose name changes with its content.
        headers = {**IMMUTABLE, "Vary": "Accept-Encoding"}
        if not accepts(request, "accept-encoding", "gzip"):
            return FileResponse(file, headers=headers)
        headers["Content-Encoding"] = "gzip"
        return Response(_gzip(file), headers=headers, media_type=guess_type(file.name)[0])
    index = BUILT / "index.html"
    if not index.is_file():
        return HTMLResponse(MISSING, 503)
    found = PAGES.fullmatch(path.strip("/"))
    return FileResponse(index, 200 if found else 404, headers=FRESH)


# The name of a file under assets/ changes with its content, so one compression serves for good.
@lru_cache(maxsize=256)
def _gzip(file: Path) -> bytes:
    return gzip.compress(file.read_bytes(), mtime=0)


def _file(folder: Path, path: str) -> Path | None:
    try:
        file = (folder / path).resolve()
        return file if file.is_file() and file.is_relative_to(folder.resolve()) else None
    except (OSError, ValueError):  # No file can have such a name.
        raise HTTPException(404, f"There is nothing at /{path:.80}") from None
