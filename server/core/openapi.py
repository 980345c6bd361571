"""The API's description: every error in it is a problem."""

from typing import Any

from fastapi import FastAPI

from .errors import MEDIA_TYPE
from .schemas import Problem

PROBLEMS: dict[int | str, dict[str, Any]] = {
    "default": {"model": Problem, "description": "A problem (RFC 9457)"}
}


def describe(app: FastAPI) -> None:
    """FastAPI describes errors as plain JSON; have it say which kind of JSON they are."""
    generate = app.openapi

    def openapi() -> dict[str, Any]:
        document = generate()
        for operations in document["paths"].values():
            for operation in operations.values():
                _mark(operation["responses"].get("default"))
        return document

    app.openapi = openapi


def _mark(response: dict[str, Any] | None) -> None:
    if response and MEDIA_TYPE not in response["content"]:
        _, content = response["content"].popitem()
        response["content"][MEDIA_TYPE] = content
