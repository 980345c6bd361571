"""Print what `GET /experiments` tells: `.venv/bin/python web/scripts/experiments.py`."""

import json

from server.routes.experiments import list_experiments


def main() -> None:
    print(json.dumps([found.model_dump(mode="json") for found in list_experiments()]))


if __name__ == "__main__":
    main()
