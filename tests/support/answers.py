"""Problems that the API answers with: status, detail, and fields."""

from typing import Any

import httpx


def detail(answer: httpx.Response, status: int) -> str:
    """The `detail` of a problem, after checking its status."""
    assert answer.status_code == status, answer.text
    return answer.json()["detail"]


def errors(answer: httpx.Response, status: int = 422) -> list[dict[str, Any]]:
    assert answer.status_code == status, answer.text
    return answer.json()["errors"]


def fields(answer: httpx.Response, status: int = 422) -> list[str]:
    """The invalid fields of a request."""
    return [error["field"] for error in errors(answer, status)]
