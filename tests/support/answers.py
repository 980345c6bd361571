"""Refusals of the API, read after their status is checked."""

from typing import Any

import httpx


def detail(answer: httpx.Response, status: int) -> str:
    """The sentence of a refusal with this status."""
    assert answer.status_code == status, answer.text
    return answer.json()["detail"]


def errors(answer: httpx.Response, status: int = 422) -> list[dict[str, Any]]:
    assert answer.status_code == status, answer.text
    return answer.json()["errors"]


def fields(answer: httpx.Response, status: int = 422) -> list[str]:
    """The fields at fault of an invalid request."""
    return [error["field"] for error in errors(answer, status)]
