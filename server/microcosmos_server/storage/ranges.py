"""Send files over HTTP with a strong ETag and byte ranges."""

import re

from fastapi import Request
from fastapi.responses import Response, StreamingResponse

from ..core.answers import knows
from ..core.errors import RangeNotSatisfiable
from ..tables import Artifact
from . import segments
from .artifacts import Artifacts

ONE_RANGE = re.compile(r"bytes=(\d{0,18})-(\d{0,18})")


def file(
    request: Request,
    artifacts: Artifacts,
    artifact: Artifact,
    headers: dict[str, str],
    media_type: str = "application/octet-stream",
) -> Response:
    """Return an artifact, 304 if the client has it, or 206 with one range of it.

    Raise what `Artifacts` raises if its first piece cannot be read.
    """
    whole = segments.whole(artifact)
    etag = f'"{whole.sha256}"'
    headers = {"ETag": etag, "Accept-Ranges": "bytes", **headers}
    if knows(request, etag):
        return Response(status_code=304, headers=headers)
    start, stop, status = 0, whole.size, 200
    wanted = request.headers.get("range")
    fresh = request.headers.get("if-range", etag) == etag
    if wanted and fresh and (part := _part(wanted, whole.size)):
        (start, stop), status = part, 206
        headers["Content-Range"] = f"bytes {start}-{stop - 1}/{whole.size}"
    headers["Content-Length"] = str(stop - start)
    content = segments.stream(artifacts, artifact, start, stop)
    return StreamingResponse(content, status, headers, media_type)


def _part(wanted: str, size: int) -> tuple[int, int] | None:
    """Return start and stop of the range; None for several ranges: then all is sent."""
    # A server may ignore a range (RFC 9110, 14.2).
    match = ONE_RANGE.fullmatch(wanted.strip())
    if not match or match.groups() == ("", ""):
        return None
    first, last = match.groups()
    start = int(first) if first else max(0, size - int(last))
    stop = min(size, int(last) + 1) if first and last else size
    if start >= size or start >= stop:
        detail = f"A range within 0 to {size - 1} is needed; got {wanted}."
        headers = {"Content-Range": f"bytes */{size}"}
        raise RangeNotSatisfiable(detail, headers=headers)
    return start, stop
