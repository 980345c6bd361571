"""A fake server that records requests and returns prepared answers."""

import json
from collections.abc import Callable
from typing import Any, NamedTuple

import httpx
import pytest

from microcosmos.client import Client, Run

RUN = "0f3c1a2b-0000-4000-8000-000000000001"


class Request(NamedTuple):
    method: str
    path: str
    document: Any
    key: str | None
    query: dict[str, str]


class Fake(NamedTuple):
    connect: Callable[[], Client]
    requests: list[Request]

    @property
    def client(self) -> Client:
        return self.connect()

    def run(self, record: dict[str, Any]) -> Run:
        return Run(self.client.connection, record)


@pytest.fixture
def record() -> dict[str, Any]:
    return {
        "id": RUN,
        "experiment": "quality-diversity",
        "name": "mine",
        "tags": [],
        "note": None,
        "status": "running",
        "requested_state": None,
        "waiting_reason": None,
        "spec": {"experiment": "quality-diversity", "seed": 4},
        "progress": 0.5,
        "eta_seconds": 75.0,
        "generation": 5,
        "generations": 10,
        "evaluations": 80,
        "evaluations_per_second": 12.5,
        "qd_score": 3.25,
        "coverage": 0.125,
        "best": 1.5,
        "summary": None,
        "error": None,
        "warning": None,
    }


@pytest.fixture
def fake() -> Callable[..., Fake]:
    def make(answers: dict[tuple[str, str], Any]) -> Fake:
        requests: list[Request] = []

        def answer(request: httpx.Request) -> httpx.Response:
            path = request.url.path.removeprefix("/api/v1/")
            sent = json.loads(request.content) if request.content else None
            key = request.headers.get("idempotency-key")
            requests.append(Request(request.method, path, sent, key, dict(request.url.params)))
            body = answers[request.method, path]
            return body if isinstance(body, httpx.Response) else httpx.Response(200, json=body)

        transport = httpx.MockTransport(answer)
        return Fake(lambda: Client("http://fake", "secret", transport=transport), requests)

    return make
