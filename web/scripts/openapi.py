"""Print the server's OpenAPI document: `.venv/bin/python web/scripts/openapi.py`."""

import json
from pathlib import Path
from tempfile import TemporaryDirectory

from microcosmos_server.app import create_app
from microcosmos_server.services.services import connect
from microcosmos_server.settings import Settings


def main() -> None:
    with TemporaryDirectory() as folder:
        app = create_app(connect(Settings(data=Path(folder))))
        print(json.dumps(app.openapi(), indent=1, sort_keys=True))


if __name__ == "__main__":
    main()
