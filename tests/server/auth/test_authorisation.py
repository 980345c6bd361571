"""Authorisation: every route of the application × every kind of principal."""

import re
from datetime import UTC, datetime, timedelta
from uuid import uuid4

import httpx
import pytest
from fastapi.routing import iter_route_contexts

from microcosmos.archive import creature
from microcosmos.spec import parse
from microcosmos_server.app import create_app
from microcosmos_server.auth import tokens
from microcosmos_server.auth.authorize import authorize, public
from microcosmos_server.auth.principal import ADMIN, READ, SHARE, WRITE
from microcosmos_server.creatures import storage as creatures
from microcosmos_server.runs.deps import own_run
from microcosmos_server.runs.schemas import Scheduling
from microcosmos_server.runs.submission import IdempotentRequest, submit
from microcosmos_server.services.services import connect
from microcosmos_server.settings import Settings
from microcosmos_server.shares.routes import find_or_add, own_share
from microcosmos_server.shares.schemas import ShareCreate
from microcosmos_server.sweeps.plan import plan
from microcosmos_server.sweeps.routes import own_sweep, request_of, submit_sweep
from microcosmos_server.sweeps.schemas import SweepCreate
from microcosmos_server.tables import Token

ROOT = "/api/v1"
PUBLIC, OWNER = "public", "owner"
"""Beside the scopes: no token at all, and `write` by the owner."""
OWNERS = (own_run, own_sweep, own_share)
OWNED = ("run_id", "sweep_id", "slug")
"""Path parameters that name something with an owner."""
OPEN = {
    "GET /healthz",
    "GET /import",
    "GET /readyz",
    "GET /s/{slug}",
    "GET /s/{slug}/{rest:path}",
    "GET /{path:path}",
}
"""Public paths outside of the API."""
OPEN_API = {
    "GET /units",
    "GET /shares/{slug}",
    "GET /shares/{slug}/creature.json",
    "GET /shares/{slug}/creatures.json",
    "GET /shares/{slug}/loop.mp4",
    "GET /commons",
    "POST /session",
    "DELETE /session",
}
"""Public paths of the API."""
SHARED = ("/runs/{run_id}", "/creatures/{sha}")
"""Beginnings of the paths that the holder of a share may read."""
HARMLESS = {"POST /runs/estimate", "POST /sweeps/estimate", "POST /session", "DELETE /session"}
"""Requests that are no GET and yet change nothing."""

IN, UNKNOWN, FORBIDDEN = "let in", 401, 403
WHO = ("none", "expired", "revoked", "reader", "other", "owner", "admin")
EXPECTED = {
    PUBLIC: dict.fromkeys(WHO, IN),
    SHARE: dict.fromkeys(WHO, IN),
    READ: dict.fromkeys(WHO, IN),
    WRITE: dict.fromkeys(WHO, IN) | {"reader": FORBIDDEN},
    OWNER: dict.fromkeys(WHO, IN) | {"reader": FORBIDDEN, "other": FORBIDDEN},
    ADMIN: dict.fromkeys(WHO, FORBIDDEN) | {"admin": IN},
}
for need in (SHARE, READ, WRITE, OWNER, ADMIN):
    EXPECTED[need] |= dict.fromkeys(("none", "expired", "revoked"), UNKNOWN)


def needs(dependant) -> set[str]:
    """The scopes that the dependencies of a route require."""
    if dependant.call in OWNERS:
        return {OWNER}
    if dependant.call is authorize:
        return set(dependant.own_oauth_scopes or ()) or {"no scope"}
    inner = [need for one in dependant.dependencies for need in needs(one)]
    return {PUBLIC} if dependant.call is public else set(inner)


@pytest.fixture(scope="module")
def routes(tmp_path_factory) -> dict[str, set[str]]:
    """All routes of the application, with the scopes that each requires."""
    nowhere = Settings(redis_url="redis://127.0.0.1:1/0", data=tmp_path_factory.mktemp("data"))
    found = iter_route_contexts(create_app(connect(nowhere)).routes)
    return {
        f"{sorted(route.methods or {'WEBSOCKET'})[0]} {route.path}": needs(route.dependant)
        for route in found
    }


@pytest.fixture(scope="module")
def api_routes(routes) -> dict[str, str]:
    """Those of the API, with the scope of each."""
    nowhere = f"{ROOT}/{{rest:path}}"
    return {
        route: need
        for route, (need,) in routes.items()
        if (f" {ROOT}/" in route or route.endswith("/metrics")) and nowhere not in route
    }


SHAPES = {"form": "svg", "kind": "replay"}
"""Other path parameters."""


def test_every_route_declares_its_scope(routes):
    """Each route has exactly one of: a scope, an owner, public."""
    for route, scopes in routes.items():
        assert len(scopes) == 1, route
        assert scopes <= EXPECTED.keys(), route
        assert route in OPEN or PUBLIC not in scopes or f" {ROOT}/" in route, route


def test_only_harmless_routes_need_no_write_scope(api_routes):
    for route, need in api_routes.items():
        method, path = route.replace(ROOT, "").split()
        shared = path == "/shares/{slug}/preview.png"
        assert need != SHARE or (method == "GET" and path.startswith(SHARED)), route
        assert (need == PUBLIC) == (f"{method} {path}" in OPEN_API or shared), route
        if method != "GET" and f"{method} {path}" not in HARMLESS:
            theirs = any(f"{{{name}}}" in path for name in OWNED) and not path.endswith("/fork")
            assert need in ((OWNER,) if theirs else (WRITE, OWNER, ADMIN)), route
        if path.startswith("/tokens"):
            assert need == (READ if path == "/tokens/current" else ADMIN), route


@pytest.fixture
def database() -> str:
    return "sqlite"


@pytest.fixture
def secrets(services) -> dict[str, str | None]:
    scopes = {"reader": READ, "other": WRITE, "owner": WRITE}
    scopes |= dict.fromkeys(("admin", "expired", "revoked"), ADMIN)
    made = {who: tokens.create(services, who, scope) for who, scope in scopes.items()}
    with services.sessions.write.begin() as session:
        past = datetime.now(UTC) - timedelta(minutes=1)
        session.get_one(Token, made["expired"].token.id).expires_at = past
    tokens.revoke(services, made["revoked"].token.id)
    return {"none": None, **{who: one.secret for who, one in made.items()}}


@pytest.fixture
def parameters(services, secrets, spec, identity):
    """Fills the parameters of a path with new objects of `owner`."""
    file = creature.document(identity(3), None, None)
    with services.sessions.write.begin() as session:
        creatures.import_files(session, file)

    owner = tokens.principal_of(services, secrets["owner"])

    def run() -> str:
        return str(
            submit(services, parse(spec), IdempotentRequest(spec, owner=owner.token))[0].id
        )

    def sweep() -> str:
        planned = plan(SweepCreate(spec=spec), parse)
        return str(
            submit_sweep(
                services, planned, request_of(planned, Scheduling(), owner=owner.token)
            )[0]
        )

    def share() -> str:
        asked = ShareCreate(creature=file["sha256"], title=uuid4().hex)
        with services.sessions.write.begin() as session:
            return find_or_add(session, asked, owner)[0].slug

    examples = {
        **{name: lambda shape=shape: shape for name, shape in SHAPES.items()},
        "run_id": run,
        "sweep_id": sweep,
        "slug": share,
        "sha": lambda: file["sha256"],
        "token_id": lambda: str(tokens.create(services, uuid4().hex, READ).token.id),
    }

    def make(path: str) -> str:
        names = re.findall(r"{(\w+)}", path.replace(":path", ""))
        assert set(names) <= examples.keys(), f"{path}: say above how an example is made"
        return path.format(**{name: examples[name]() for name in names})

    return make


def test_each_principal_reaches_exactly_the_permitted_routes(
    served, services, secrets, parameters, api_routes
):
    """Nor does a token to read order audits or measurements by any request."""
    wrong = []
    with httpx.Client(base_url=served(auth="required"), timeout=20) as http:
        for route, need in api_routes.items():
            method, path = route.split()
            url = parameters(path)
            for who, secret in secrets.items():
                expected, ordered = EXPECTED[need][who], services.jobs.audits.count
                if need == OWNER and expected == IN:  # The one before may be gone.
                    url = parameters(path)
                sent = {"Authorization": f"Bearer {secret}"} if secret else {}
                found = status(http, method, url, sent)
                met = found if found in (UNKNOWN, FORBIDDEN) else IN
                if met != expected or found in (405, 500):
                    wrong.append(f"{route} needs {need}: {who} met {found}")
                if who == "reader" and services.jobs.audits.count != ordered:
                    wrong.append(f"{route}: a reader orders an audit or a measurement")
    assert wrong == []


def status(http: httpx.Client, method: str, url: str, headers: dict[str, str]) -> int:
    """Return the status of an answer, without its body: streams never end."""
    json = None if method in ("GET", "DELETE") else {}
    with http.stream(method, url, headers=headers, json=json) as answer:
        return answer.status_code


def test_an_unknown_route_is_never_reached(served, secrets):
    address = served(auth="required")
    for who in ("none", "admin"):
        sent = {"Authorization": f"Bearer {secrets[who]}"} if secrets[who] else {}
        nowhere = httpx.get(f"{address}{ROOT}/secrets", headers=sent)
        assert nowhere.status_code == (404 if sent else 401)
        other = httpx.put(f"{address}{ROOT}/runs", headers=sent)
        assert other.status_code == (405 if sent else 401)
    assert other.headers["allow"] == "GET, HEAD, POST"
