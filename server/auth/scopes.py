"""What each route of the API needs. One that is not named here is not reached by anybody."""

import re
from dataclasses import dataclass
from functools import cache
from typing import Any

from starlette.routing import compile_path

from ..tables import Run, Share, Sweep
from .principal import ADMIN, READ, WRITE

PUBLIC, OWNER = "public", "owner"
"""Beside the scopes: no token at all, and `write` by whoever it belongs to."""

ROOT = "/api/v1"
METRICS = "/metrics"
"""Stands at the root, yet tells what only those may know who may read."""

NEEDS = {
    f"GET {METRICS}": READ,
    "GET /openapi.json": READ,
    "GET /experiments": READ,
    "GET /runs": READ,
    "POST /runs": WRITE,
    "POST /runs/estimate": READ,
    "GET /runs/{run_id}": READ,
    "PATCH /runs/{run_id}": OWNER,
    "DELETE /runs/{run_id}": OWNER,
    "POST /runs/{run_id}/pause": OWNER,
    "POST /runs/{run_id}/resume": OWNER,
    "POST /runs/{run_id}/cancel": OWNER,
    "POST /runs/{run_id}/extend": OWNER,
    "POST /runs/{run_id}/restore": OWNER,
    "POST /runs/{run_id}/fork": WRITE,  # What it makes is the forker's own.
    "GET /runs/{run_id}/generations": READ,
    "GET /runs/{run_id}/species": READ,
    "GET /runs/{run_id}/log": READ,
    "GET /runs/{run_id}/archive": READ,
    "GET /runs/{run_id}/archive/history": READ,
    "GET /runs/{run_id}/archive/centroids": READ,
    "GET /runs/{run_id}/archive.h5": READ,
    "GET /runs/{run_id}/archive.csv": READ,
    "GET /runs/{run_id}/results": READ,
    "GET /runs/{run_id}/results.csv": READ,
    "GET /runs/{run_id}/targets": READ,
    "GET /sweeps": READ,
    "POST /sweeps": WRITE,
    "POST /sweeps/estimate": READ,
    "GET /sweeps/{sweep_id}": READ,
    "PATCH /sweeps/{sweep_id}": OWNER,
    "DELETE /sweeps/{sweep_id}": OWNER,
    "GET /sweeps/{sweep_id}/summary": READ,
    "GET /sweeps/{sweep_id}/curves": READ,
    "POST /sweeps/{sweep_id}/pause": OWNER,
    "POST /sweeps/{sweep_id}/resume": OWNER,
    "POST /sweeps/{sweep_id}/cancel": OWNER,
    "POST /sweeps/{sweep_id}/restore": OWNER,
    "POST /creatures": WRITE,
    "POST /creatures/{sha}/measure": WRITE,
    "GET /creatures/{sha}": READ,
    "GET /creatures/{sha}/creature.h5": READ,
    "GET /creatures/{sha}/ancestors": READ,
    "GET /creatures/{sha}/children": READ,
    "GET /creatures/{sha}/network.svg": READ,
    "GET /creatures/{sha}/network.dot": READ,
    "GET /creatures/{sha}/network.py": READ,
    "GET /creatures/{sha}/network.npz": READ,
    "GET /creatures/{sha}/replay": READ,
    "GET /creatures/{sha}/motion": READ,
    "GET /creatures/{sha}/audit": READ,
    "GET /creatures/{sha}/strip.png": READ,
    "GET /creatures/{sha}/preview.png": READ,
    "GET /creatures/{sha}/film.gif": READ,
    "GET /creatures/{sha}/film.mp4": READ,
    "GET /creatures/{sha}/measurement": READ,
    "GET /shares": READ,
    "POST /shares": WRITE,
    "GET /shares/{slug}": PUBLIC,
    "GET /shares/{slug}/preview.png": PUBLIC,
    "GET /shares/{slug}/creatures/{sha}": PUBLIC,
    "GET /shares/{slug}/creatures/{sha}/creature.h5": PUBLIC,
    "GET /shares/{slug}/creatures/{sha}/ancestors": PUBLIC,
    "GET /shares/{slug}/creatures/{sha}/network.{form}": PUBLIC,
    "GET /shares/{slug}/creatures/{sha}/replay": PUBLIC,
    "GET /shares/{slug}/creatures/{sha}/motion": PUBLIC,
    "GET /shares/{slug}/creatures/{sha}/{kind}": PUBLIC,
    "GET /shares/{slug}/runs/{run_id}": PUBLIC,
    "GET /shares/{slug}/runs/{run_id}/generations": PUBLIC,
    "GET /shares/{slug}/runs/{run_id}/archive": PUBLIC,
    "GET /shares/{slug}/runs/{run_id}/archive/history": PUBLIC,
    "GET /shares/{slug}/runs/{run_id}/archive/centroids": PUBLIC,
    "GET /shares/{slug}/runs/{run_id}/archive.h5": PUBLIC,
    "GET /shares/{slug}/runs/{run_id}/archive.csv": PUBLIC,
    "DELETE /shares/{slug}": OWNER,
    "GET /commons": PUBLIC,
    "GET /events": READ,
    "GET /workers": READ,
    "GET /queue": READ,
    "GET /tags": READ,
    "GET /tokens/current": READ,
    "GET /tokens": ADMIN,
    "POST /tokens": ADMIN,
    "DELETE /tokens/{token_id}": ADMIN,
    "POST /session": PUBLIC,
    "DELETE /session": PUBLIC,
}

OWNED: dict[str, type[Any]] = {"run_id": Run, "sweep_id": Sweep, "slug": Share}
"""What has an `owner`, by the parameter of a path that names it."""


@dataclass(frozen=True)
class Need:
    """What a request needs, and the parameters in its path."""

    need: str
    parameters: dict[str, str]


class Unnamed(LookupError):
    """Nobody said what a path needs; `methods` are those for which somebody did."""

    def __init__(self, methods: list[str]):
        super().__init__()
        self.methods = methods


def need_of(method: str, path: str) -> Need:
    """What a request needs; `Unnamed` where that is not in the table."""
    asked = "GET" if method == "HEAD" else method
    others = []
    for named, pattern, need in _patterns():
        if found := pattern.match(path):
            if named == asked:
                return Need(need, found.groupdict())
            others.append(named)
    raise Unnamed(others)


@cache
def _patterns() -> list[tuple[str, re.Pattern[str], str]]:
    split = [(*key.split(" "), need) for key, need in NEEDS.items()]
    return [
        (method, compile_path(path if path == METRICS else ROOT + path)[0], need)
        for method, path, need in split
    ]
