"""The page, as `make` has built it."""

from pathlib import Path

from fastapi import APIRouter
from fastapi.responses import FileResponse, HTMLResponse, Response
from starlette.exceptions import HTTPException

BUILT = Path(__file__).parents[2] / "web" / "dist"
MISSING = """<!doctype html><html lang="en"><title>Microcosmos</title>
<p>The page has not been built yet: <code>make</code> in the checkout builds it.
The API is at <a href="/api/v1/openapi.json">/api/v1</a>."""
FOR_EVER = {"Cache-Control": "public, max-age=31536000, immutable"}
FRESH = {"Cache-Control": "no-cache"}

router = APIRouter(include_in_schema=False)


@router.get("/{path:path}")
def page(path: str) -> Response:
    """A built file, else the page itself, which knows what its paths mean."""
    if path == "api" or (path.startswith(("api/", "assets/")) and not _file(path)):
        raise HTTPException(404, f"There is nothing at /{path}")
    if file := _file(path):  # The names of assets change with their content.
        return FileResponse(file, headers=FOR_EVER if path.startswith("assets/") else FRESH)
    index = BUILT / "index.html"
    if not index.is_file():
        return HTMLResponse(MISSING, 503)
    return FileResponse(index, headers=FRESH)


def _file(path: str) -> Path | None:
    try:
        file = (BUILT / path).resolve()
        return file if file.is_file() and file.is_relative_to(BUILT.resolve()) else None
    except (OSError, ValueError):  # No file can have such a name.
        raise HTTPException(404, f"There is nothing at /{path:.80}") from None
