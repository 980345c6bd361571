"""Print the answer of `GET /experiments`: `.venv/bin/python web/scripts/experiments.py`."""

import json

from microcosmos_server.specs.routes import built_in


def main() -> None:
    print(json.dumps([found.model_dump(mode="json") for found in built_in()]))


if __name__ == "__main__":
    main()
