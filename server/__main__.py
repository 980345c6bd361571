"""`python -m server`: the server alone."""

import uvicorn

from .settings import Settings

GRACE = 5
"""Seconds that open connections have to end."""


def main() -> None:
    settings = Settings()
    uvicorn.run(
        "server.app:create",
        factory=True,
        host=settings.host,
        port=settings.port,
        timeout_graceful_shutdown=GRACE,
    )


if __name__ == "__main__":
    main()
